"""How the components of the reversible counter fail: faults of `ReversibleCounter`, by component.

Not among them: a single transient flip, bridges between lines, a drifting check speed.
Source: components as for the two-counter device, modes after IEC 61508-2 table A.1 [A].
"""

from __future__ import annotations

from safety import Fault, missing, open_circuit, stuck, welded

LOST, FAST, SLOW = 10, 16, 10  # one pulse in so many is missing: 10 % lost, oscillator 6.7 % fast, 10 % slow [A]
BOTH = (0, 1)


def stages(point: str, width: int) -> list[Fault]:
    """Each bit of a register or word stuck at 0 and at 1."""
    return [Fault(stuck(value, bit=k), [point]) for k in range(width) for value in BOTH]


def lines(point: str) -> list[Fault]:
    """A line stuck at 0 and at 1."""
    return [Fault(stuck(value), [point]) for value in BOTH]


def component_modes() -> dict[str, list[Fault]]:
    """The failure modes, by component."""
    return {
        "speed generator": [
            Fault(stuck(0), ["axle.pulse"], name="speed generator open or short"),
            Fault(missing(1, every=LOST), ["axle.pulse"], name="speed pulses lost"),
        ],
        "oscillator": [
            Fault(stuck(0), ["f1"], name="oscillator stops"),
            Fault(missing(1, every=SLOW), ["f1"], name="oscillator slow"),
            Fault(missing(1, every=FAST), ["axle.pulse"], name="oscillator fast"),
        ],
        "pulse divider": [*stages("divider.rest", 11), *lines("divider.carry"), *stages("fed_back", 10)],
        "up line": lines("up"),
        "down line": lines("down"),
        "up/down counter": stages("n", 10),
        "check speed": stages("limit", 10),
        "comparator": lines("over"),
        "supply": [Fault(stuck(0), ["supply"], name="supply lost")],
        "relay": [
            Fault(open_circuit(), ["coil"], name="relay coil open"),
            Fault(open_circuit(), ["contact"], name="relay contact open"),
            Fault(welded(), ["contact"], name="relay contact welded"),
        ],
    }
