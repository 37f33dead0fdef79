"""How the components of TS-7 fail: faults of `Ts7`, by component.

Each fault names the points at which it acts in the equipment; rates are given elsewhere.  Not among them: another ratio
of a divider than by a stuck stage, a single transient flip, lost or weak pulses of the speed generator, the pulse
generator of bits and words, an inverter out of tolerance, an oscillator too slow.
Source: components and modes after the fault table of the equipment [A]; a wrong row is that of 90 km/h, the worst.
"""

from __future__ import annotations

from collections.abc import Iterator

from safety import Fault, byzantine, flip, frozen, missing, open_circuit, reads, stuck, welded
from safety.kinds import Kind

CHANNELS = "abc"
WORD_90, WORD_25, SMALLEST_WHEEL = 191, 53, 156
ALL_FAST, ONE_FAST = 16, 10  # one generator pulse in so many is missing: shared oscillator 6.7 % fast, own 11 % [A]


def lines_of(value: int) -> tuple[int, ...]:
    """The lines of a word that are on, as bit numbers: with a second row selected besides they are stuck at 1."""
    return tuple(k for k in range(value.bit_length()) if value >> k & 1)


def fewer_pulses(one_in: int) -> Kind:
    """Oscillator too fast, as its channel sees it: in its shorter frames one generator pulse in so many is missing.

    At `axle.pulse` the oscillator is shared, at `a.f_s` it is channel a's own; the speed-up is 1/(one_in - 1).
    """
    return missing(1, every=one_in)


def channel_faults(n: str) -> list[Fault]:
    """The ten ways in which channel n and its relays fail."""
    return [
        Fault(stuck(0), [f"{n}.f_v"], name=f"{n}: no f_v"),
        Fault(stuck(1), [f"{n}.f_p"], name=f"{n}: f_p in every frame"),
        Fault(stuck(0), [f"{n}.ring.overflow.o*"], name=f"{n}: ring stuck"),
        Fault(reads(WORD_90), [f"lines_{n}.word"], name=f"{n}: wrong word"),
        Fault(stuck(0), [f"{n}.comparator.u"], name=f"{n}: comparator at 0"),
        Fault(stuck(0), [f"{n}.comparator.latch"], name=f"{n}: latch at release"),
        Fault(welded(), [f"common.{n}.nbrr_relay.contact"], name=f"{n}: NBRR welded"),
        Fault(welded(), [f"common.{n}.chr_relay.contact"], name=f"{n}: CHR welded"),
        Fault(stuck(0), [f"{n}.check.faulty"], name=f"{n}: fault detector dead"),
        Fault(stuck(1), [f"{n}.comparator.latch"], name=f"{n}: latch at brake"),
    ]


def shared_faults() -> list[Fault]:
    """The nine failures common to the channels or behind them."""
    words = [f"lines_{n}.word" for n in CHANNELS]
    return [
        Fault(stuck(0), ["axle.pulse"], name="speed generator dead"),
        Fault(reads(WORD_90), words, name="wrong row in all channels"),
        Fault(stuck(1, bit=lines_of(WORD_25)), words, name="signal lines wire-ORed with 25"),
        Fault(reads(SMALLEST_WHEEL), ["wheel_switch"], name="wheel switch on 780 mm"),
        Fault(reads(0), ["wheel_switch"], name="wheel switch open"),
        Fault(fewer_pulses(ALL_FAST), ["axle.pulse"], name="shared oscillator fast"),
        Fault(welded(), ["common.nb_relay.contact"], name="NB output welded"),
        Fault(welded(), ["common.eb_relay.contact"], name="EB relay welded"),
        Fault(byzantine(), ["common.sync.isolate_*"], name="synchronisation isolates anyone"),
    ]


def component_faults() -> list[Fault]:
    """The 39 faults over which the hazard's cut sets are sought: ten a channel, nine shared."""
    return [fault for n in CHANNELS for fault in channel_faults(n)] + shared_faults()


def component_modes() -> dict[str, list[Fault]]:
    """The failure modes for injection, by component; what is not among them is said at the top of this file."""
    return {component: list(faults) for component, faults in _modes()}


def _modes() -> Iterator[tuple[str, list[Fault]]]:
    both = (stuck(0), stuck(1))
    for n in CHANNELS:
        lines = [f"lines_{n}.line.s{v}" for v in (0, 25, 45, 65, 75, 90)]
        cells = [stuck(value, bit=k) for value in (0, 1) for k in range(8)]
        yield (
            f"oscillator {n}",
            [
                Fault(frozen(), [f"{n}.output.level", f"{n}.rev"], name=f"oscillator {n} stops"),
                Fault(fewer_pulses(ONE_FAST), [f"{n}.f_s"], name=f"oscillator {n} fast"),
            ],
        )
        yield f"row select {n}", _rows([f"lines_{n}.word"], n)
        yield f"ring {n}", [Fault(stuck(0), [f"{n}.ring.overflow.o*"]), Fault(stuck(1), [f"{n}.ring.overflow.o*"])]
        yield f"word select {n}", [Fault(stuck(0), [f"{n}.ring.select.j{w}"]) for w in range(4)]
        yield f"data matrix {n}", [Fault(kind, [f"{n}.ring.matrix.j{w}"]) for w in range(4) for kind in cells]
        yield f"level converters {n}", [Fault(kind, [line]) for line in lines for kind in both]
        yield f"overflow gates {n}", [Fault(kind, [f"{n}.ring.overflow.o{w}"]) for w in range(4) for kind in both]
        yield f"divide by 16 {n}", [Fault(stuck(v, bit=3), [f"{n}.div{w}.n"]) for w in (0, 3) for v in (0, 1)]
        yield f"comparator {n}", [Fault(kind, [f"{n}.comparator.{p}"]) for p in ("u", "latch") for kind in both]
        yield f"roll-back {n}", [Fault(kind, [f"{n}.rollback.{p}"]) for p in ("u", "latch") for kind in both]
        yield f"fault detector {n}", [Fault(kind, [f"{n}.check.faulty"]) for kind in both]
        yield (
            f"output amplifier {n}",
            [
                *(Fault(kind, [f"{n}.output.level"]) for kind in both),
                Fault(stuck(1), [f"{n}.output.toggle"], name=f"output amplifier {n} oscillates"),
            ],
        )
        yield f"lowering {n}", [Fault(kind, [f"{n}.lowered"]) for kind in both]
        yield f"relays {n}", [_relay(mode, f"common.{n}.{r}_relay") for r in ("nbrr", "chr") for mode in RELAY_MODES]
        yield f"isolation {n}", [Fault(kind, [f"common.sync.isolate_{n}"]) for kind in both]
        yield f"supply {n}", [Fault(stuck(0), [f"common.{n}.supply"])]
    yield "output relays", [_relay(mode, f"common.{relay}_relay") for relay in ("nb", "eb") for mode in RELAY_MODES]
    yield "speed generator", [Fault(kind, ["axle.pulse"]) for kind in both] + [Fault(flip(), ["axle.backward"])]
    yield "shared oscillator", [Fault(fewer_pulses(ALL_FAST), ["axle.pulse"], name="oscillator of all fast")]
    yield "shared rows", _rows([f"lines_{n}.word" for n in CHANNELS], "of all")
    yield "wheel switch", [Fault(reads(w), ["wheel_switch"]) for w in (0, *range(156, 173, 2))]
    yield "power", [Fault(stuck(0), [f"power.{p}"]) for p in ("inverter", "mg", "change_over", "supply")]


RELAY_MODES = ("coil open", "contact open", "contact welded")


def _rows(words: list[str], whose: str) -> list[Fault]:
    """The row of 90 km/h in place of the selected one, and that of 25 besides it."""
    return [
        Fault(reads(WORD_90), words, name=f"row {whose} wrong"),
        Fault(stuck(1, bit=lines_of(WORD_25)), words, name=f"row {whose} and that of 25"),
    ]


def _relay(mode: str, relay: str) -> Fault:
    where, how = mode.split()
    return Fault(open_circuit() if how == "open" else welded(), [f"{relay}.{where}"], name=f"{relay} {mode}")
