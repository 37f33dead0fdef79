"""Two-counter ATC: a slower train and a slower oscillator are never judged worse, window by window.

Main results: of two windows that open at one instant, the slower train's lasts no shorter and counts no less, so if it
brakes then so does the faster one; at constant speeds, where a window depends on its phase alone, so it is reading by
reading with equal phases.  At other speeds that is false: the slower run's next window may lie in a faster stretch.
An oscillator that lags behind in any way never releases where the reference brakes; the permitted speed moves in
proportion to its error, up for a fast one.
Source: monotone counts [D]; drifts [A].
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import ceil

from models.two_counter.circuit import READ_OUT
from models.two_counter.equipment import Equipment
from models.two_counter.numbers import N1F, PRESETS
from models.two_counter.pairs import TwoOscillators, TwoTrains
from models.two_counter.train import KMH
from proofs.two_counter_decision import runs_ahead
from proofs.two_counter_formulas import (
    EDGE,
    FAR,
    PREPARATION,
    ROWS,
    Formula,
    far_enough,
    greatest_permitted,
    limit_of_release,
    line,
    named,
    preparation_in_order,
    steadily,
    through_the_window,
    turned,
)
from safety import (
    PROVED,
    REFUTED,
    Bit,
    Int,
    Scenario,
    Seen,
    all_of,
    bit,
    claim,
    implies,
    last,
    once,
    previous,
    select,
    total,
)

LONG = 2**40 - 1  # pulses that are counted

# --- TC-13: two trains -----------------------------------------------------------------------------------------------

TRAINS = ("first", "second")  # the second is the faster one


def opened(s: Seen, train: str) -> Bit:
    """The gate has opened at the step before, with nothing counted but its first pulse."""
    c = s[train].circuit
    return c.counter2.counting & (c.counter2.n == 0) & (c.counter1.n == 1) & ~c.ff6.on


def opened_together(s: Seen) -> Bit:
    """Both gates opened at one instant, the phase of axle against oscillator being the same."""
    return opened(s, "first") & opened(s, "second") & (s.first.train.phase == s.second.train.phase)


def one_preset(s: Seen) -> Bit:
    """The check speed selected is one of the seven, and always the same."""
    m = s["first.selection.preset"]
    return (m == previous(m, PRESETS[-1])) | ~once(bit(True))


def never_behind(s: Seen) -> Bit:
    """From the first step on the second train has come no less far than the first; one check speed.

    It has where it is never slower, also of speeds between whole units.
    """
    a, b = turned(s.speed_a).int() + s.speed_a, turned(s.speed_b).int() + s.speed_b
    return one_preset(s) & (a <= b) & (b < FAR)


def place(s: Seen, train: str) -> Int:
    """Way since the opening of its gate, as its counter 2 and phase have it, up to the next signal 3."""
    counter = s[train].circuit.counter2
    closed = select(counter.counting, 0, previous(s["first.selection.preset"], PRESETS[-1]).int())
    return EDGE * (counter.n.int() + closed) + s[train].train.phase


def both_too_fast() -> Scenario:
    """Both too fast under 250 km/h (258.75 on the frequency scale)."""
    start = {f"{t}.{r}": v for t in TRAINS for r, v in
             {"circuit.counter2.counting": True, "circuit.counter1.n": 1, "train.phase": 7}.items()}  # fmt: skip
    return Scenario(2200, {**line(250), "speed_a": 260 * KMH, "speed_b": 261 * KMH}, start)


def has_read(s: Seen, train: str) -> Bit:
    """Its first window has been read."""
    return once(s[train].circuit.signal1)


def released(s: Seen, train: str) -> Bit:
    """Its first reading released."""
    return once(s[train].circuit.signal1 & s[train].circuit.ff6.on & ~has_read(s, train))


def pulses(s: Seen, train: str) -> Int:
    """Oscillator pulses in its first window, from the step on that follows signal 3."""
    return total((s[train].circuit.gate & ~has_read(s, train)).word(), LONG).int()


def abreast_or_ahead(s: Seen) -> Bit:
    """Until the first train is read the second is ahead; what the second was found safe for, so is the first."""
    a, b = (s[t].circuit for t in TRAINS)
    m = previous(s["first.selection.preset"], PRESETS[-1])
    a_way, b_way = turned(s.speed_a).int(), turned(s.speed_b).int()
    ahead = (a_way <= b_way) & (place(s, "second") - b_way == place(s, "first") - a_way)
    no_worse = implies(b.ff6.on, a.ff6.on) & (pulses(s, "first") >= pulses(s, "second"))
    same = ~(a.ff6.on ^ b.ff6.on) & (a.counter1.n == b.counter1.n) & (pulses(s, "first") == pulses(s, "second"))
    both = ahead & same & ~released(s, "second") & (b.counter2.n < m) & (a.counter2.n < m)
    waits = select(a.counter2.counting, a.counter2.n < m, a.counter2.n < READ_OUT)
    left = ahead & waits & no_worse & ~released(s, "second") & (b.counter2.n < READ_OUT)
    unread = select(a.counter2.counting, select(b.counter2.counting, both, left), ~b.counter2.counting & left)
    read = implies(released(s, "second"), a.ff6.on) & (pulses(s, "first") >= pulses(s, "second"))
    due = a.counter2.counting | (a.counter2.n < READ_OUT)
    under_way = has_read(s, "first") | (due & select(has_read(s, "second"), read, unread))
    nothing = [~has_read(s, t) & ~released(s, t) & (pulses(s, t) == 0) for t in TRAINS]
    return select(once(bit(True)), under_way, all_of(opened_together(s), a_way == 0, b_way == 0, *nothing))


def first_reading(s: Seen, train: str) -> Bit:
    """Its first window is read at this step."""
    return s[train].circuit.signal1 & ~has_read(s, train)


def judged_no_better(s: Seen) -> Bit:
    """Where the first reading of the slower train brakes, that of the faster one has braked or does now."""
    now = first_reading(s, "second") & ~s.second.circuit.ff6.on
    braked = select(has_read(s, "second"), ~released(s, "second"), now)
    return implies(first_reading(s, "first") & ~s.first.circuit.ff6.on, braked)


def lasts_no_shorter(s: Seen) -> Bit:
    """While the slower train is not read its window has held as many pulses as the faster one's, or more."""
    return has_read(s, "first") | (pulses(s, "first") >= pulses(s, "second"))


@claim(TwoTrains, anywhere=True, start=opened_together, given=never_behind, lemmas=[abreast_or_ahead], expect=PROVED,
       requirement="TC-13", source="[D]", witness=both_too_fast())  # fmt: skip
def of_two_windows_the_faster_is_judged_no_better(s: Seen) -> Bit:
    """Two windows open at one instant, one train never behind the other from then on, as one that is never slower:
    its window lasts no longer and counts no more, and where the other's reading brakes, so does its."""
    return judged_no_better(s) & lasts_no_shorter(s)


def third_reading(s: Seen, train: str) -> Bit:
    """Signal 1 for the third time: the second window is read."""
    return s[train].circuit.signal1 & (readings(s, train) == 2)


def readings(s: Seen, train: str) -> Int:
    """Readings so far, up to three; the first is that after power-up."""
    return total(s[train].circuit.signal1.word(), 3).int()


def brakes_at_the_third(s: Seen, train: str) -> Bit:
    """The third reading, before this step, braked."""
    return once(third_reading(s, train) & ~s[train].circuit.ff6.on)


def later_and_faster() -> Scenario:
    """The second train just below 250 km/h, the first at half its speed; after 4070 periods both too fast."""
    slow = greatest_permitted(ROWS[250])

    def at(first: int) -> Callable[[int], int]:
        return lambda k: first if k < 4070 else 265 * KMH

    return Scenario(8000, {**line(250), "speed_a": at(slow // 2), "speed_b": at(slow)})


@claim(TwoTrains, given=never_behind, expect=REFUTED, requirement="TC-13", source="[D]", scenario=later_and_faster(),
       twin_of=of_two_windows_the_faster_is_judged_no_better)  # fmt: skip
def reading_by_reading_the_faster_is_judged_no_better(s: Seen) -> Bit:
    """From power-up on, one train never behind the other: where the third reading of the slower one brakes, so
    does the third of the faster one.  False: the slower run's window lies later, in a faster stretch."""
    both = (readings(s, "first") == 3) & (readings(s, "second") == 3)
    return implies(both & brakes_at_the_third(s, "first"), brakes_at_the_third(s, "second"))


# --- TC-7: two oscillators -------------------------------------------------------------------------------------------


def counted_since(s: Seen, circuit: str) -> Int:
    """Pulses that its oscillator has given in this window, before this step, counted by the claim."""
    c, pulse = s[circuit], s.pulse_a if circuit == "first" else s.pulse_b
    given = total((pulse & c.gate).word(), LONG).int()
    return given - last(given, c.signal3, 0)


def counted_now(s: Seen, circuit: str) -> Int:
    """The same with the pulse of this moment."""
    c, pulse = s[circuit], s.pulse_a if circuit == "first" else s.pulse_b
    return select(c.signal3, 0, counted_since(s, circuit)) + (pulse & c.gate).word()


def lags_behind(s: Seen) -> Bit:
    """At each moment of a window the second oscillator has given no more pulses than the first; 2**40 in all."""
    given = [total((p & s[c].gate).word(), LONG) for c, p in (("first", s.pulse_a), ("second", s.pulse_b))]
    return all_of(*(n < LONG for n in given)) & (counted_now(s, "second") <= counted_now(s, "first"))


def keeps_count(circuit: str) -> Formula:
    """Lemma: counter 1 holds the pulses of the window up to n1F, FF6 says whether they were reached."""

    def lemma(s: Seen) -> Bit:
        c, n = s[circuit], counted_since(s, circuit)
        low, enough = (n < N1F) & (c.counter1.n.int() == n) & ~c.ff6.on, (n >= N1F) & c.ff6.on
        reset = (c.counter1.n == 0) & ~c.ff6.on
        in_step = select(c.counter2.counting | (c.counter2.n < 4), low | enough, reset)
        return (n >= 0) & (c.counter2.counting | (c.counter2.n < PREPARATION)) & in_step

    return named(f"the {circuit} circuit keeps count", lemma)


def same_signals(s: Seen) -> Bit:
    """Both circuits have the same edges, so the same signals; what the second was found safe for, so is the first."""
    a, b = s.first.counter2, s.second.counter2
    behind = a.counting | (a.n < 4)
    return (
        ~(a.counting ^ b.counting)
        & (a.n == b.n)
        & implies(behind, counted_since(s, "second") <= counted_since(s, "first"))
    )


def judged_no_worse(s: Seen) -> Bit:
    """What the first commands the second commands too, if it is brake."""
    return implies(s.a.signal1 & s.a.ff7, s.b.ff7)


@claim(TwoOscillators, given=lags_behind, lemmas=[keeps_count("first"), keeps_count("second"), same_signals],
       expect=PROVED, requirement="TC-7", source="[D]")  # fmt: skip
def a_lagging_oscillator_never_releases_more(s: Seen) -> Bit:
    """An oscillator that at each moment of each window has given no more pulses than another one, slow or drifting in
    any way: where the reading brakes with that one, it brakes with this one."""
    return judged_no_worse(s)


EDGES_EVERY_OTHER = {"preset": ROWS[250], "edge": lambda k: k % 2 == 0}


@claim(TwoOscillators, expect=REFUTED, requirement="TC-7", twin_of=a_lagging_oscillator_never_releases_more,
       scenario=Scenario(2200, {**EDGES_EVERY_OTHER, "pulse_a": lambda k: k % 25 > 0, "pulse_b": True}))  # fmt: skip
def a_leading_oscillator_never_releases_more(s: Seen) -> Bit:
    """The same of any two oscillators.  False: one that gives every pulse reaches n1F, one that loses 4 % does not."""
    return judged_no_worse(s)


def limit_with(error: int) -> None:
    """Declare: an oscillator so many ppm off moves the limit of no release in proportion, exactly."""
    edge = EDGE + error  # ppm: a step of EDGE = 10**6 units becomes shorter by as many

    def limit(m: int) -> Fraction:
        return limit_of_release(m, edge)

    def formula(s: Seen) -> Bit:
        return implies(s.signal1 & through_the_window(s, far_enough(s, limit)), s.brake)

    def one_less(s: Seen) -> Bit:
        return implies(s.signal1 & through_the_window(s, far_enough(s, lambda m: limit(m) - 1)), s.brake)

    how = f"{abs(error) / 10_000:g} % {'fast' if error > 0 else 'slow'}"
    name = f"no_release_with_an_oscillator_{abs(error)}_ppm_{'fast' if error > 0 else 'slow'}"
    formula.__doc__ = f"Oscillator {how}: every window at the limit times {1 + error / 1_000_000:g} or more brakes."
    one_less.__doc__ = f"Oscillator {how}: so does one at 1/2000 km/h less."
    settings = {"oscillator.error": error}
    lemmas = [preparation_in_order, runs_ahead(edge)]
    claim(Equipment, settings=settings, lemmas=lemmas, expect=PROVED, requirement="TC-7", source="[D] (3)",
          witness=steadily(5, ceil(limit(ROWS[5]))))(named(name, formula))  # fmt: skip
    run = steadily(250, ceil(limit(ROWS[250]) - 1), edge=edge)
    claim(Equipment, settings=settings, expect=REFUTED, requirement="TC-7", scenario=run, twin_of=formula)(
        named(f"{name}_one_unit_slower", one_less)
    )


for ppm in (-20_000, -102, 10_000):
    limit_with(ppm)
