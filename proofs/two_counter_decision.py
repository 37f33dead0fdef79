"""Two-counter ATC: what one sample decides, for every phase of axle and oscillator and every preset.

One step is one oscillator period, 155.8695 us; speeds in 1/2000 km/h on the frequency scale.  The selection is kept
during the window; that is a premise.

Main results: a sample at or above f2E * n1F/(n1F - 1) all through its window brakes, one at or below f2E releases; both
limits are exact to one unit of speed, for each of the seven presets.  Equation (4) disagrees with the circuit at
n1 = n1F, and there only: it is the circuit with n1F + 1.
Source: section 5 in its consistent reading, equations (3) to (5) [P]; presets [D]; n1F [A].
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import ceil

from models.two_counter.equipment import Equipment
from models.two_counter.numbers import CHECK_SPEEDS, N1F, PRESETS
from models.two_counter.train import KMH
from proofs.two_counter_formulas import (
    EDGE,
    ROWS,
    Formula,
    at_each,
    at_least,
    at_most,
    counted,
    counting,
    edges,
    far_enough,
    greatest_permitted,
    kept,
    last_preset,
    least_too_fast,
    limit_of_release,
    named,
    position,
    preparation_in_order,
    pulses,
    safe,
    steadily,
    through_the_window,
    turned,
)
from safety import (
    PROVED,
    REFUTED,
    Bit,
    Scenario,
    Seen,
    UInt,
    claim,
    implies,
    last,
    select,
    since,
)

# --- TC-1: the relay holds what the last count says ------------------------------------------------------------------

COUNT = "circuit.counter1.n1f"
OPEN = None  # n1F, left open in its range


def needed(s: Seen, n1f: int | None) -> int | UInt:
    """A number of pulses, or n1F where it is left open."""
    return n1f or s[COUNT]


def had(s: Seen, n1f: int | None = N1F) -> Bit:
    """Since the last signal 3 the gate has let n1F pulses through, or more."""
    return since(s.gate & (pulses(s) + 1 >= needed(s, n1f)), ~s.signal3)


def last_sample_had(s: Seen, n1f: int | None = N1F) -> Bit:
    """The window before the last signal 1, that of this step included, held n1F pulses or more; false before any."""
    return select(s.signal1, had(s, n1f), since(s.signal1 & had(s, n1f), ~s.signal1))


def counted_in(n1f: int | None) -> Formula:
    """Lemma: counter 1 holds the pulses of the window up to n1F; FF6 says whether they were reached."""

    def lemma(s: Seen) -> Bit:
        in_step = (counted(s).int() == pulses(s).int()) & (pulses(s) < needed(s, n1f))
        in_gate = ~(safe(s) ^ had(s, n1f)) & (had(s, n1f) | in_step)
        return select(counting(s), in_gate, (pulses(s) == 0) & ((edges(s) >= 4) | ~(safe(s) ^ had(s, n1f))))

    return named(f"counter 1 and FF6 tell whether {n1f or 'n1F'} pulses came", lemma)


def decision(n1f: int | None) -> list[Formula]:
    """The lemmas about one sample."""
    return [preparation_in_order, counted_in(n1f)]


@claim(Equipment, lemmas=decision(N1F), expect=PROVED, requirement="TC-1", source="[P] section 5; equality [A]")
def releases_exactly_after_n1f_pulses(s: Seen) -> Bit:
    """From each signal 1 to the next the brake is released just when the window before held n1F pulses or more."""
    return ~s.brake ^ ~last_sample_had(s)


@claim(Equipment, lemmas=decision(OPEN), expect=PROVED, symbolic=[COUNT], requirement="TC-1",
       source="[P] section 5; [D] 1884 < n1F")  # fmt: skip
def releases_exactly_after_n1f_pulses_whatever_n1f_is(s: Seen) -> Bit:
    """The same for each n1F from 1885 to 2047: the decision does not hang on the value that is assumed."""
    return ~s.brake ^ ~last_sample_had(s, OPEN)


def had_more(s: Seen) -> Bit:
    """Since the last signal 3 the gate has let more than n1F pulses through."""
    return since(s.gate & (pulses(s) >= needed(s, OPEN)), ~s.signal3)


AT_F2E = steadily(250, greatest_permitted(ROWS[250]), 2100)


@claim(Equipment, expect=REFUTED, requirement="TC-1", source="[P] equation (4)", scenario=AT_F2E,
       twin_of=releases_exactly_after_n1f_pulses)  # fmt: skip
def brakes_by_equation_4(s: Seen) -> Bit:
    """Equation (4), brake for n1 <= n1F, is what the circuit does.  False at n1 = n1F, reached at f2E: it releases."""
    return ~s.brake ^ ~last_sample_had(s, N1F + 1)


@claim(Equipment, expect=REFUTED, symbolic=[COUNT], requirement="TC-1", source="[P] equation (4)", scenario=AT_F2E,
       twin_of=releases_exactly_after_n1f_pulses_whatever_n1f_is)  # fmt: skip
def releases_after_one_pulse_more_whatever_n1f_is(s: Seen) -> Bit:
    """One pulse more is needed for each n1F from 1885 to 2047.  False: at n1F itself it releases."""
    return ~s.brake ^ ~select(s.signal1, had_more(s), since(s.signal1 & had_more(s), ~s.signal1))


@claim(Equipment, lemmas=decision(N1F + 1), expect=PROVED, settings={COUNT: N1F + 1},
       requirement="TC-1", source="[P] equation (4)")  # fmt: skip
def equation_4_is_the_circuit_with_n1f_plus_1(s: Seen) -> Bit:
    """Equation (4), brake for n1 <= n1F, is what the circuit does with n1F + 1 in gate circuit 1."""
    return ~s.brake ^ ~last_sample_had(s, N1F + 1)


# --- TC-2: no release on overspeed -----------------------------------------------------------------------------------


def runs_ahead(edge: int = EDGE, presets: Sequence[int] = PRESETS) -> Formula:
    """Lemma: at overspeed since signal 3 the position is ahead of counter 1, at n1F/(n1F - 1) of f2E; FF6 is reset."""

    def lemma(s: Seen) -> Bit:
        whole = through_the_window(s, far_enough(s, lambda m: limit_of_release(m, edge), presets))
        way = turned(s.speed).int() - last(turned(s.speed).int() + s.speed, s.signal3, 0)

        def ahead(m: int) -> Bit:
            return (N1F - 1) * (position(s, edge) + 1) > edge * m * (counted(s).int() - 1)

        in_step = (counted(s).int() == pulses(s).int()) & (counted(s) >= 1) & (position(s, edge) >= way)
        in_gate = in_step & (edges(s) < last_preset(s)) & at_each(last_preset(s), ahead, presets)
        return select(counting(s), implies(whole, ~safe(s) & in_gate), (pulses(s) == 0) & implies(whole, ~safe(s)))

    return named("at overspeed counter 2 runs ahead of counter 1", lemma)


@claim(Equipment, lemmas=[preparation_in_order, runs_ahead()], expect=PROVED,
       requirement="TC-2", source="[D] (5) made exact", witness=steadily(5, least_too_fast(ROWS[5])))  # fmt: skip
def no_release_on_overspeed(s: Seen) -> Bit:
    """All seven presets, every phase: where the train comes as far as at f2E * n1F/(n1F - 1) or further, from signal 3
    to each moment of a window, its reading brakes.  So it does at any speeds from there up, whole units or not."""
    return implies(s.signal1 & through_the_window(s, far_enough(s, limit_of_release)), s.brake)


def releases_one_unit_below(v: int) -> None:
    """Declare: at this check speed the limit of no release is exact."""

    def slower(m: int) -> Fraction:
        return limit_of_release(m) - 1

    def formula(s: Seen) -> Bit:
        return implies(s.signal1 & through_the_window(s, far_enough(s, slower)), s.brake)

    formula.__doc__ = f"""Check speed {v} km/h, 1/2000 km/h less than that all through a window: its reading brakes.
    False: with an edge just before an oscillator pulse counter 1 reaches n1F."""
    claim(Equipment, expect=REFUTED, requirement="TC-2", scenario=steadily(v, ceil(slower(ROWS[v]))),
          twin_of=no_release_on_overspeed)(named(f"no_release_one_unit_slower_at_{v}", formula))  # fmt: skip


def raised() -> Scenario:
    """Too fast under 5 km/h for most of its window; then too fast under 250 km/h."""
    change = 2260
    inputs = {"lines.s5": lambda k: k < change, "lines.s250": True}
    return Scenario(4400, {**inputs, "speed": lambda k: least_too_fast(ROWS[5]) if k < change else 260 * KMH})


@claim(Equipment, expect=REFUTED, defeat=True, requirement="TC-2", source="[D]", twin_of=no_release_on_overspeed,
       scenario=raised())  # fmt: skip
def no_release_on_overspeed_under_changing_check_speeds(s: Seen) -> Bit:
    """The same, whatever is selected meanwhile: too fast for the check speed of each moment.  False: one raised during
    the window prolongs it, and n1F is reached although the train was always too fast."""
    return implies(s.signal1 & since(s.signal3, at_least(s, least_too_fast) | ~counting(s)), s.brake)


# --- TC-3: no needless brake -----------------------------------------------------------------------------------------


def whole_window(s: Seen, condition: Bit) -> Bit:
    """At signal 3, and since then as long as the gate was open, the condition has held; the selection was kept."""
    return since(s.signal3 & condition, ~s.signal3 & ((condition & kept(s)) | ~counting(s)))


def stays_behind(s: Seen) -> Bit:
    """Not above f2E since signal 3 the position is behind counter 1, at f2E; once there were n1F, FF6 says so."""
    whole = whole_window(s, at_most(s, greatest_permitted))

    def behind(m: int) -> Bit:
        return position(s) < greatest_permitted(m) * counted(s).int()

    in_gate = (edges(s) < last_preset(s)) & (counted(s) >= 1) & (counted(s) < N1F) & at_each(last_preset(s), behind)
    return implies(whole, select(counting(s), safe(s) | in_gate, safe(s) | (edges(s) >= 4)))


@claim(Equipment, lemmas=[preparation_in_order, stays_behind], expect=PROVED,
       requirement="TC-3", source="[D] eq. (3)", witness=steadily(5, greatest_permitted(ROWS[5])))  # fmt: skip
def no_needless_brake(s: Seen) -> Bit:
    """All seven presets, every phase: f2E or less all through a window, and its reading releases."""
    return implies(s.signal1 & whole_window(s, at_most(s, greatest_permitted)), ~s.brake)


def brakes_one_unit_above(v: int) -> None:
    """Declare: at this check speed the limit of no needless brake is exact."""

    def faster(m: int) -> int:
        return greatest_permitted(m) + 1

    def formula(s: Seen) -> Bit:
        return implies(s.signal1 & whole_window(s, at_most(s, faster)), ~s.brake)

    formula.__doc__ = f"""Check speed {v} km/h, 1/2000 km/h more than that all through a window: its reading releases.
    False: with an edge just after an oscillator pulse one pulse is missing."""
    run = steadily(v, faster(ROWS[v]), left=faster(ROWS[v]) - 1)
    claim(Equipment, expect=REFUTED, requirement="TC-3", scenario=run, twin_of=no_needless_brake)(
        named(f"no_needless_brake_one_unit_faster_at_{v}", formula)
    )


for speed in CHECK_SPEEDS:
    releases_one_unit_below(speed)
    brakes_one_unit_above(speed)
