"""Two-counter ATC: how soon the brake comes, from any moment of a sampling period and after a change of the preset.

One step is one oscillator period, 155.8695 us; speeds in whole 1/2000 km/h on the frequency scale.  Overspeed: from the
next 1/2000 km/h at or above f2E * n1F/(n1F - 1) on, for the check speed selected, which is kept meanwhile.

Main results: overspeed brakes within 2m + 10 edges, whatever came before, and the brake stays: 4018 periods
(0.6263 s) at 250 km/h, 4349 (0.6779 s) at 5, exact for each of the seven presets.  After a change of the check speed
it takes m + 11 edges and those that are missing in the sample in progress, with the decoder for "reached or passed";
with one for equality the command may be held for the whole capacity of counter 2.
Source: a sample is preparation, count and read-out [P], [D]; decoder [A].
"""

from __future__ import annotations

from typing import Any

from models.two_counter.circuit import READ_OUT
from models.two_counter.equipment import Equipment
from models.two_counter.numbers import CHECK_SPEEDS, N1F, PRESETS
from models.two_counter.train import KMH
from models.two_counter.variants import EqualityDecoder
from proofs.two_counter_formulas import (
    EDGE,
    PREPARATION,
    ROWS,
    at_each,
    at_least,
    counted,
    counting,
    edges,
    greatest_permitted,
    kept,
    last_preset,
    least_too_fast,
    line,
    named,
    position,
    preparation_in_order,
    preset,
    safe,
)
from safety import (
    PROVED,
    REFUTED,
    Bit,
    Int,
    Scenario,
    Seen,
    UInt,
    age,
    all_of,
    claim,
    implies,
    last,
    select,
    since,
    total,
)


def periods(m: int) -> int:
    """Oscillator periods in which overspeed turns 2m + 10 edges."""
    return -(-EDGE * (2 * m + PREPARATION + READ_OUT) // least_too_fast(m))


LONGEST = max(map(periods, ROWS.values()))


def overspeed(s: Seen) -> Bit:
    """Too fast for the check speed selected, which is that of the step before."""
    return at_least(s, least_too_fast) & kept(s)


def lasting(s: Seen) -> UInt:
    """For how many steps before this one there was overspeed."""
    return age(overspeed(s), LONGEST)


def clean(s: Seen, m: int) -> Bit:
    """FF6 is reset and stays so: nothing but overspeed since the last signal 3."""
    ahead = position(s) >= least_too_fast(m) * (counted(s).int() - 1)
    return ~safe(s) & implies(counting(s), (edges(s) < m) & (counted(s) >= 1) & ahead)


def way_to_the_brake(s: Seen) -> Bit:
    """While overspeed lasts, the way it has made is in counter 2 and the phase, up to the end of the next sample."""

    def made(m: int) -> Bit:
        way = least_too_fast(m) * lasting(s).int()
        sound, braked = clean(s, m), clean(s, m) & s.circuit.ff2.on
        spoilt = select(edges(s) < m, position(s) >= way, s.train.phase >= way)
        in_gate = spoilt | (sound & (position(s) + EDGE * (m + PREPARATION) >= way)) | braked
        before = position(s) + EDGE * m >= way
        after = sound & (edges(s) < READ_OUT) & (position(s) + EDGE * (2 * m + PREPARATION) >= way)
        return select(counting(s), in_gate, before | after | braked)

    return implies(lasting(s) > 0, at_each(last_preset(s), made))


def each_in_turn(span: int = 4400) -> Scenario:
    """Each check speed for so many periods, at the overspeed of each."""
    inputs: dict[str, Any] = {f"lines.s{v}": lambda k, i=i: k // span == i for i, v in enumerate(CHECK_SPEEDS)}
    return Scenario(span * len(ROWS), {**inputs, "speed": lambda k: least_too_fast(PRESETS[k // span])})


LEMMAS = [preparation_in_order, way_to_the_brake]


@claim(Equipment, lemmas=LEMMAS, expect=PROVED, requirement="TC-4", source="[D] 2 n2E + 5 pulses",
       witness=each_in_turn())  # fmt: skip
def overspeed_brakes_in_time(s: Seen) -> Bit:
    """All seven presets, from any moment: overspeed, from the next 1/2000 km/h above the limit on, for (2 n2E + 5)/f2E
    brakes, and brakes as long as it lasts."""
    return all_of(
        *(implies((preset(s) == m) & overspeed(s) & (lasting(s) >= periods(m) - 1), s.brake) for m in ROWS.values())
    )


def worst_case(v: int) -> Scenario:
    """Released by one sample; in the next a standstill just after signal 3, until FF6 is set; then overspeed."""
    m, slow = ROWS[v], greatest_permitted(ROWS[v])
    way = EDGE * (2 * PREPARATION + m)
    stands = -(-(way - way % slow) // slow)
    inputs = {**line(v), "speed": lambda k: slow if k < stands else 0 if k < stands + N1F else least_too_fast(m)}
    return Scenario(stands + N1F + periods(m) + 10, inputs, {"train.phase": way % slow})


def brakes_a_period_earlier(v: int) -> None:
    """Declare: at this check speed the time is exact."""
    m = ROWS[v]

    def formula(s: Seen) -> Bit:
        return implies((preset(s) == m) & overspeed(s) & (lasting(s) >= periods(m) - 2), s.brake)

    formula.__doc__ = f"Check speed {v} km/h: overspeed brakes a period earlier than that."
    claim(Equipment, expect=REFUTED, requirement="TC-4", scenario=worst_case(v), twin_of=overspeed_brakes_in_time)(
        named(f"overspeed_brakes_a_period_earlier_at_{v}", formula)
    )


for speed in CHECK_SPEEDS:
    brakes_a_period_earlier(speed)

# --- TC-14: another check speed --------------------------------------------------------------------------------------

LONG = 2**40 - 1  # edges that are counted: ten years


def turned(s: Seen) -> Int:
    """Edges before this step."""
    return total(s["train.edge"].word(), LONG).int()


def changes(s: Seen) -> Bit:
    """Another preset is selected than a step before."""
    return ~kept(s)


def turned_since(s: Seen) -> Int:
    """Edges from the last change on, its step included."""
    return turned(s) - last(turned(s), changes(s), 0)


def rest(s: Seen) -> Int:
    """Edges that the sample in progress lacked at the last change; 0 outside its window."""
    lacks = preset(s).int() - edges(s)
    return last(select(counting(s) & (lacks > 0), lacks, 0), changes(s), 0)


def overspeed_since_the_change(s: Seen) -> Bit:
    """Ever since the last change there was overspeed."""
    return since(changes(s), overspeed(s))


def edges_to_the_brake(s: Seen, spare: int = 0) -> Int:
    """The edges after which the brake holds."""
    return last_preset(s).int() + PREPARATION + READ_OUT + 1 - spare + rest(s)


def progress(s: Seen) -> Bit:
    """While overspeed lasts after a change, the edges made and those left do not exceed the number claimed."""

    def made(m: int) -> Bit:
        n, bound = edges(s).int(), edges_to_the_brake(s) - turned_since(s)
        sound, braked = clean(s, m), clean(s, m) & s.circuit.ff2.on
        spoilt = select(m - n > 1, m - n, 1) + PREPARATION + m + READ_OUT <= bound
        in_gate = spoilt | (sound & (m - n + READ_OUT <= bound)) | braked
        before = PREPARATION - n + m + READ_OUT <= bound
        after = sound & (n < READ_OUT) & (READ_OUT - n <= bound)
        return select(counting(s), in_gate, before | after | braked)

    return implies(overspeed_since_the_change(s), at_each(last_preset(s), made))


def braked_in_time(s: Seen, spare: int = 0) -> Bit:
    """The brake holds once the edges have come, that of this step included."""
    made = turned_since(s) + s["train.edge"].word()
    return implies(overspeed_since_the_change(s) & overspeed(s) & (made >= edges_to_the_brake(s, spare)), s.brake)


def lowered(passed: int = 1000, steps: int = 9000) -> Scenario:
    """At 200 km/h under 250; in the second window, `passed` edges on, 5 km/h is selected."""
    fast = 200 * KMH
    change = EDGE * (2 * PREPARATION + ROWS[250] + passed) // fast
    return Scenario(steps, {"lines.s250": True, "lines.s5": lambda k: k >= change, "speed": fast})


AFTER = [preparation_in_order, progress]


@claim(Equipment, lemmas=AFTER, expect=PROVED, requirement="TC-14", source="[D] m/2 + 6 pulses and the rest",
       witness=lowered())  # fmt: skip
def another_check_speed_brakes_in_time(s: Seen) -> Bit:
    """After any change of the check speed, with overspeed (from the next 1/2000 km/h on) from then on: brake within
    m/2 + 5.5 pulses of the new preset and those that the sample in progress lacks of it."""
    return braked_in_time(s)


@claim(Equipment, expect=REFUTED, requirement="TC-14", twin_of=another_check_speed_brakes_in_time,
       scenario=lowered())  # fmt: skip
def another_check_speed_brakes_half_a_pulse_earlier(s: Seen) -> Bit:
    """The same within an edge less.  False where counter 2 has passed the new preset: the gate waits for an edge."""
    return braked_in_time(s, 1)


@claim(EqualityDecoder, expect=REFUTED, defeat=True, requirement="TC-14", source="[A] equality decoder",
       twin_of=another_check_speed_brakes_in_time, scenario=lowered(100))  # fmt: skip
def another_check_speed_brakes_in_time_by_equality(s: Seen) -> Bit:
    """The same with a decoder that sees the preset only while it stands there.  False: counter 2, past the new preset,
    runs on to its capacity, and the release is held."""
    return braked_in_time(s)


def second_reading(s: Seen) -> Bit:
    """Signal 1, another one having come since the change, and overspeed ever since it."""
    return s.signal1 & overspeed(s) & since(s.signal1 & overspeed_since_the_change(s), overspeed(s))


def sound_after_a_reading(s: Seen) -> Bit:
    """After the first reading since the change nothing but overspeed is counted from the next signal 3 on."""

    def made(m: int) -> Bit:
        return select(counting(s), clean(s, m), (edges(s) >= READ_OUT) | clean(s, m))

    read = since(s.signal1 & overspeed_since_the_change(s), overspeed(s))
    return implies(read, at_each(last_preset(s), made))


@claim(Equipment, lemmas=[preparation_in_order, sound_after_a_reading],
       expect=PROVED, requirement="TC-14", source="[D]", witness=lowered())  # fmt: skip
def the_second_reading_after_a_change_brakes(s: Seen) -> Bit:
    """After any change of the check speed, with overspeed (from the next 1/2000 km/h on) from then on: the second
    reading brakes, and all later."""
    return implies(second_reading(s), s.brake)


@claim(Equipment, expect=REFUTED, requirement="TC-14", twin_of=the_second_reading_after_a_change_brakes,
       scenario=lowered())  # fmt: skip
def the_first_reading_after_a_change_brakes(s: Seen) -> Bit:
    """The first reading brakes too.  False: FF6 may be set already by a sample that began under the old preset."""
    return implies(s.signal1 & overspeed(s) & overspeed_since_the_change(s), s.brake)
