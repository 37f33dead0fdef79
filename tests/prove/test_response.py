"""Response times by closed form: never shorter than enumeration finds them, and every ingredient can fail."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Annotated, Any

import pytest

from models.ts7.parts import Comparator
from models.ts7.train import Bench
from proofs import ts7_channel
from proofs.ts7_formulas import at_least_kmh, latch_at_the_ends, wheel_set_right
from safety.model import Model, power_up
from safety.prove import closed_form, race, response
from safety.prove.claims import BITS, Claim, Seen, persists, total
from safety.prove.closed_form import ClosedForm
from safety.prove.extremes import Extremes
from safety.prove.flows import Reader, whole
from safety.prove.problem import build_problem
from safety.prove.response import by_response
from safety.system import ANY
from safety.terms import U3, U4, Bit, Int, Term, implies, select
from safety.terms.direct import evaluate
from safety.terms.graph import BIT, uint, variable
from tests.prove.small import asked

PERIOD, MODULUS, FASTEST = 12, 16, 7
Speed = Annotated[Int, (0, FASTEST)]
Phase = Annotated[Int, (0, PERIOD - 1)]
SOLVERS = ["z3", "cvc5"]


class Race(Model, tick_s="125e-6"):
    """A speed pulse for each 12 units of phase, a reference pulse for each 16 of `j`; the comparator brakes."""

    phase: Phase = power_up(ANY)
    j: U4 = power_up(ANY)
    comparator: Comparator

    def step(self, speed: Speed, word: U3) -> tuple[Race, Bit]:
        turned, total = self.phase + speed, self.j + word
        full = turned >= PERIOD
        comparator, brake = self.comparator.step(up=full, down=total.bit(4))
        phase = select(full, turned - PERIOD, turned).clip(0, PERIOD - 1)
        return Race(phase=phase, j=total.low(4), comparator=comparator), brake


def latch(s: Seen) -> Bit:
    """Three ahead it is set, none ahead it is not."""
    c = s.comparator
    return implies(c.u == 3, c.latch) & implies(c.u == 0, ~c.latch)


def moves(brakes: bool, speed: int, steps: int, word: int) -> Claim:
    """So many steps under a word, no slower (no faster) than a speed: it brakes (it does not)."""

    def formula(s: Seen) -> Bit:
        enough = s.speed >= speed if brakes else s.speed <= speed
        return implies(persists(enough & (s.word == word), steps), s.out if brakes else ~s.out)

    return asked(formula, Race, anywhere=True, start=latch, lemmas=(latch,))


@functools.cache
def least_steps(brakes: bool, speed: int, word: int) -> int:
    """The least number of steps for which `moves` holds, by going through all states and all choices of the speed."""
    speeds = range(speed, FASTEST + 1) if brakes else range(speed + 1)
    ends = {3: (True,), 0: (False,)}
    states = [
        (phase, j, u, b)
        for phase, j, u in itertools.product(range(PERIOD), range(MODULUS), range(4))
        for b in ends.get(u, (False, True))
    ]

    def after(phase: int, j: int, u: int, b: bool, v: int) -> tuple[int, int, int, bool]:
        up, down = phase + v >= PERIOD, j + word >= MODULUS
        u = min(u + 1, 3) if up and not down else max(u - 1, 0) if down and not up else u
        return (phase + v) % PERIOD, (j + word) % MODULUS, u, u == 3 or (b and u != 0)

    following = {s: [after(*s, v) for v in speeds] for s in states}
    wrong = {s for s in states if any(t[3] is not brakes for t in following[s])}
    steps = 1
    while wrong:  # states from which so many steps can end wrongly
        wrong = {s for s in states if any(t in wrong for t in following[s])}
        steps += 1
    return steps


def proved(claim: Claim) -> bool:
    outcome = by_response(build_problem(claim), 20)
    assert outcome is not None
    answer, method = outcome
    assert answer.agreed_by == (SOLVERS if answer.proved else [])
    assert answer.proved == bool(method) == (not answer.failed)
    return answer.proved


CASES = [
    # brakes, speed, word, steps beyond the exact number until it is proved
    (True, 3, 3, 6), (True, 3, 2, 1), (True, 5, 6, 12), (True, 6, 7, 6),
    (False, 2, 3, 1), (False, 2, 4, 1), (False, 4, 6, 8), (False, 1, 3, 1),
]  # fmt: skip


@pytest.mark.parametrize(("brakes", "speed", "word", "more"), CASES)
def test_a_response_time_is_proved_close_to_the_exact_one_and_never_below(
    brakes: bool, speed: int, word: int, more: int
) -> None:
    exact = least_steps(brakes, speed, word)
    assert not proved(moves(brakes, speed, exact - 1, word))
    assert proved(moves(brakes, speed, exact + more, word))


def longer(form: ClosedForm) -> ClosedForm:
    return replace(form, steps=form.steps + 2)


def narrower(form: ClosedForm) -> ClosedForm:
    return replace(form, accumulators=tuple(replace(x, high=x.high - x.whole) for x in form.accumulators))


def faster(form: ClosedForm) -> ClosedForm:
    return replace(form, rates=tuple((flow, least + 1) for flow, least in form.rates))


@pytest.mark.parametrize("plant", [longer, narrower, faster])
def test_enumeration_sees_a_closed_form_that_says_too_much(
    plant: Callable[[ClosedForm], ClosedForm], monkeypatch: pytest.MonkeyPatch
) -> None:
    found = response.closed_forms

    def planted(*given: Any) -> Iterator[Any]:
        return ((plant(form), obligations) for form, obligations in found(*given))

    monkeypatch.setattr(response, "closed_forms", planted)
    assert proved(moves(True, 3, least_steps(True, 3, 2) - 1, 2))


def test_enumeration_sees_events_that_are_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(closed_form.Question, "several", lambda self: self._variable(False, 6, self.form.steps))
    assert proved(moves(True, 3, least_steps(True, 3, 2) - 1, 2))


# --- facts that are not so are refused, however they were found ------------------------------------------------------

TRUE_CLAIM = (True, 3, 60, 2)


def refused(problem_claim: Claim) -> str:
    outcome = by_response(build_problem(problem_claim), 20)
    assert outcome is not None
    assert not outcome[0].proved
    return outcome[0].failed


def test_the_claim_that_is_then_spoilt_is_proved() -> None:
    assert proved(moves(*TRUE_CLAIM))


def test_ranges_that_are_too_narrow_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    greatest = Extremes.greatest
    monkeypatch.setattr(Extremes, "greatest", lambda self, number, step=0: greatest(self, number, step) - 1)
    why = refused(moves(*TRUE_CLAIM))
    assert "what is held stays held" in why or "facts of one step" in why


def test_sums_that_are_not_so_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Extremes, "holds", lambda self, condition, step=0: True)
    assert "sums of one step" in refused(moves(*TRUE_CLAIM))


def test_a_set_that_is_not_held_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(race, "_held", lambda problem, potential, base, latched, timeout: latched)
    assert "what is held stays held" in refused(moves(*TRUE_CLAIM))


def test_a_set_that_does_not_conclude_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    held = race._held

    def wider(*given: Any) -> Bit:
        return held(*given) | True

    monkeypatch.setattr(race, "_held", wider)
    assert refused(moves(*TRUE_CLAIM))


def test_a_sum_of_steps_is_no_row_of_steps() -> None:
    """`total` counts steps that need not follow one another, so nothing about a row of them may be used."""

    def formula(s: Seen) -> Bit:
        fast = (s.speed >= 3) & (s.word == 2)
        return implies(fast & (total(fast.word(), 60) >= 59), s.out)

    refused(asked(formula, Race, anywhere=True, start=latch, lemmas=(latch,)))


def test_a_real_number_is_no_watch() -> None:
    def formula(s: Seen) -> Bit:
        return implies((s.speed.real() >= 1) & persists(s.speed >= 3, 60) & (s.word == 2), s.out)

    assert refused(asked(formula, Race, anywhere=True, start=latch, lemmas=(latch,)))


def test_a_lemma_that_is_not_so_is_refused() -> None:
    def wrong(s: Seen) -> Bit:
        return s.comparator.u != 1

    claim = replace(moves(*TRUE_CLAIM), lemmas=(latch, wrong))
    assert "lemma" in refused(claim)


@pytest.mark.parametrize(
    "formula",
    [
        lambda s: s.out | (s.comparator.u != 3),
        lambda s: implies(s.speed >= 3, s.out),
        lambda s: implies(persists(s.speed >= 3, 60), s.out) & s.out,
    ],
)
def test_other_claims_are_not_its_business(formula: Callable[[Seen], Bit]) -> None:
    assert by_response(build_problem(asked(formula, Race)), 20) is None


def test_a_claim_in_bits_is_not_its_business() -> None:
    assert by_response(build_problem(replace(moves(*TRUE_CLAIM), arithmetic=BITS)), 20) is None


# --- TS-7 ------------------------------------------------------------------------------------------------------------


def brakes(steps: int, given: Callable[[Seen], Bit] = wheel_set_right, word: int = 53, kmh: int = 27) -> Claim:
    def formula(s: Seen) -> Bit:
        fast = (s.speed >= at_least_kmh(kmh)) & (s.word == word) & (s.wheel == 172)
        return implies(persists(fast, steps), s.brake)

    return asked(formula, Bench, given=given, lemmas=(latch_at_the_ends(),))


@pytest.mark.parametrize("steps", [2050, *(pytest.param(steps, marks=pytest.mark.slow) for steps in (1900, 2065))])
def test_two_km_h_above_is_not_proved_for_times_that_runs_refute(steps: int) -> None:
    refused(brakes(steps))  # the run of 2065: ts7_channel.brakes_within_2065_frames


def test_two_km_h_above_is_proved_within_seventy_frames_of_the_longest_run_known() -> None:
    assert proved(brakes(2135))


def test_half_a_wheel_step_and_no_signal_are_not_proved() -> None:
    refused(brakes(2400, ts7_channel.within_half_a_step, 191, 92))
    assert "no carry" in refused(brakes(3242, word=0, kmh=2))


# --- sums ------------------------------------------------------------------------------------------------------------

X: Any = variable("x", uint(3))
Y: Any = variable("y", uint(2))
A: Any = variable("a", BIT)
B: Any = variable("b", BIT)
READ: dict[str, Any] = {
    "not": ~A, "and": A & B, "or": A | B, "xor": A ^ B, "implies": implies(A, B), "select of bits": select(A, B, ~B),
    "add": X + Y, "subtract": X - Y, "multiply": X * 3, "select": select(A, X.int(), Y - 5), "low": (X + Y).low(3),
    "lower": (X + Y).low(2), "race": select(A & ~B, (X + 1).int(), select(B & ~A, X - 1, X.int())), "within": X < Y,
}  # fmt: skip


@pytest.mark.parametrize("term", READ.values(), ids=READ.keys())
def test_a_term_is_the_sum_that_it_is_read_as(term: Term) -> None:
    reader = Reader([X, Y, A, B], {})
    total = reader.term(reader(term))
    for x, y, a, b in itertools.product(range(8), range(4), (False, True), (False, True)):
        value, summed = evaluate([term, total], {X: x, Y: y, A: a, B: b})
        assert int(value) == summed


Taken, Sum, Level = Annotated[Int, (-3, -1)], Annotated[Int, (0, 1000)], Annotated[Int, (0, 63)]


class Drain(Model, tick_s="1e-3"):
    """A pulse of the clock fills by 16, an event takes what the input says, which is below 0; full at 32."""

    j: U4 = power_up(ANY)
    u: Level = power_up(0)
    a: Sum = power_up(0)
    last: Taken = power_up(-1)
    latch: Bit = power_up(False)

    def step(self, w: Taken, c: Bit) -> tuple[Drain, Bit]:
        counted = self.j + 1
        drained = c & (self.u >= 3) & (self.a < 990)
        u = (self.u + select(counted.bit(4), whole(16), 0) + select(drained, w, 0)).clip(0, 63)
        a = (self.a - select(drained, w, 0)).clip(0, 1000)
        return Drain(j=counted.low(4), u=u, a=a, last=w, latch=self.latch | (self.u >= 32)), self.latch


def test_a_steady_number_below_zero_adds_up_to_less() -> None:
    """The same number below 0 more often is a lower sum: a closed form that says otherwise proves what is false."""

    def latches(s: Seen) -> Bit:
        """Drained by one in each event, with one way to fill."""
        return implies(persists((s.w == s.last) & (s.w == -1) & (s.a < 900), 300), s.latch)

    found = by_response(build_problem(asked(latches, Drain)), 20.0)
    assert found is None or not found[0].proved
