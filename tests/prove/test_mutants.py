"""Mutation coverage: each fate of a mutant, on a small climber whose mutants can be judged by hand."""

from __future__ import annotations

import inspect
from random import Random
from typing import NamedTuple

import pytest

from safety.model import Model, point, power_up
from safety.prove import mutants, mutation_questions
from safety.prove.claims import REFUTED, Claim, Scenario, Seen
from safety.prove.mutants import (
    COUNTEREXAMPLE,
    EQUIVALENT,
    KILLED,
    KINDS,
    PROOF_LOST,
    SLACK,
    TWIN,
    UNCLAIMED,
    UNDECIDED,
    VACUOUS,
    Fate,
    examine,
)
from safety.prove.mutation import SELECTOR, mutants_of
from safety.prove.mutation_case import Subject
from safety.prove.mutation_operators import TRANSPARENT, edits
from safety.prove.mutation_runs import confirmed, single
from safety.prove.outcome import Outcome
from safety.prove.solve import Disagreement
from safety.terms import U2, U3, U4, U7, Bit, implies, select
from safety.terms import graph as terms_graph
from safety.terms.direct import evaluate
from safety.terms.graph import BIT, Term, integer, postorder, uint, variable, variables
from safety.terms.values import bit
from safety.tracing import trace
from tests.prove.small import asked


class Lamp(NamedTuple):
    on: Bit


class Climber(Model, event="tick"):
    """Climbs to 5 while told to, and lights a lamp there."""

    n: U3 = power_up(0)
    lit: Bit = power_up(False)
    aside: U2 = power_up(0)

    def step(self, go: Bit) -> tuple[Climber, Lamp]:
        n = select(go & (self.n < 5), (self.n + 1).low(3), self.n)
        lit = point("lit now", self.lit | (self.n == 5))
        return Climber(n=n, lit=lit, aside=(self.aside + 1).low(2)), Lamp(on=lit)


def at_most_five(s: Seen) -> Bit:
    """The climber stays at 5."""
    return s.n <= 5


def never_seven(s: Seen) -> Bit:
    """It never reaches 7."""
    return s.n != 7


def never_five(s: Seen) -> Bit:
    """It never reaches 5."""
    return s.n != 5


def three_or_less_is_dark(s: Seen) -> Bit:
    """The lamp is dark as long as the climber is low."""
    return implies(s.n <= 3, ~s.on)


def lit_means_top(s: Seen) -> Bit:
    """Lemma: the lamp is lit at the top only."""
    return implies(s.lit, s.n == 5) & (s.n <= 5)


CLIMBS = Scenario(12, {"go": True})
TOP = asked(at_most_five, Climber, id="top", lemmas=(at_most_five,), witness=CLIMBS)
BRITTLE = asked(never_seven, Climber, id="brittle", lemmas=(at_most_five,))
BELOW = asked(never_five, Climber, id="below", expect=REFUTED, twin_of="top", scenario=CLIMBS)
DARK = asked(three_or_less_is_dark, Climber, id="dark", lemmas=(lit_means_top,))


def fates(*claims: Claim) -> dict[str, Fate]:
    """What became of each mutant, by what it says."""
    subject = Subject(claims)
    found = examine(subject, range(1, len(subject.mutants.mutants) + 1))
    return {f"{f.mutant.was}: {f.mutant.change}": f for f in found}


def fate(mutant: str, *claims: Claim) -> Fate:
    """What became of one mutant."""
    subject = Subject(claims)
    (number,) = [m.number for m in subject.mutants.mutants if f"{m.was}: {m.change}" == mutant]
    return examine(subject, [number])[0]


@pytest.fixture(scope="module")
def judged() -> dict[str, Fate]:
    return fates(TOP, BELOW)


def test_every_mutant_has_one_fate(judged: dict[str, Fate]) -> None:
    mutants = mutants_of(Climber).mutants
    assert [f.mutant.number for f in judged.values()] == [m.number for m in mutants] == [*range(1, len(mutants) + 1)]
    assert {f.kind for f in judged.values()} <= set(KINDS)


@pytest.mark.parametrize(
    ("mutant", "kind", "claim"),
    [
        ("(n < 5): <= for <", COUNTEREXAMPLE, "top"),
        ("(n < 5): 6 for 5", COUNTEREXAMPLE, "top"),
        ("(n + 1): - for +", COUNTEREXAMPLE, "top"),
        ("(n < 5): 4 for 5", TWIN, "below"),
        ("(n + 1): 0 for 1", TWIN, "below"),
        ("go: stuck at 0", TWIN, "below"),
        ("go: stuck at 1", SLACK, ""),  # nothing says that it waits to be told
        ("n at power-up: 1 for 0", SLACK, ""),
        ("(aside + 1): - for +", UNCLAIMED, ""),
    ],
)  # fmt: skip
def test_a_mutant_meets_its_fate(judged: dict[str, Fate], mutant: str, kind: str, claim: str) -> None:
    fate = judged[mutant]
    assert fate.kind == kind, fate
    assert fate.claim == claim or not claim


def test_a_lost_proof_is_found_anew_or_the_claim_is_broken() -> None:
    """At 6 the lemma is gone, the claim still true by another one: slack; beyond that the claim breaks."""
    assert fate("(n < 5): <= for <", BRITTLE).kind == SLACK
    assert fate("(n < 5): stuck at 1", BRITTLE).kind == COUNTEREXAMPLE


def test_a_proof_that_is_lost_and_not_found_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nothing decides the claim on the mutant, its fate says which lemma is lost; it is no kill."""
    monkeypatch.setattr(mutants, "decide", lambda problem, limits: Outcome(problem.claim, UNDECIDED))
    found = fate("(n < 5): <= for <", BRITTLE)
    assert found.kind == PROOF_LOST
    assert "at most five" in found.how


def test_equivalent_in_all_states_that_the_lemmas_leave() -> None:
    """Above 5 there is no state: there >= says what == says; at 4 it does not."""
    assert fate("(n == 5): >= for ==", DARK).kind == EQUIVALENT
    assert fate("(lit | (n == 5)): ^ for |", DARK).kind != EQUIVALENT
    assert fate("(n == 5): 4 for 5", DARK).kind == SLACK  # "low" is 3 or less: nothing says when it is lit


def stays_lit(s: Seen) -> Bit:
    """Once lit it stays lit."""
    return implies(s.lit, s.on)


STAYS = asked(stays_lit, Climber, id="stays")
ABOVE_FIVE = "(n == 5): >= for =="


def test_what_one_claim_has_proved_of_all_runs_helps_another() -> None:
    """That there is no state above 5 only the other claim says."""
    assert fate(ABOVE_FIVE, STAYS).kind == UNDECIDED
    assert fate(ABOVE_FIVE, STAYS, TOP).kind == EQUIVALENT


def at_most_four(s: Seen) -> Bit:
    """It stays below 5: false."""
    return s.n <= 4


def goes(s: Seen) -> Bit:
    """It is told to climb."""
    return s.go


@pytest.mark.parametrize(
    "other",
    [
        asked(never_seven, Climber, id="unproved", lemmas=(at_most_four,)),
        asked(never_seven, Climber, id="begun high", lemmas=(at_most_five,), start=at_most_four, anywhere=True),
        asked(never_seven, Climber, id="told", lemmas=(at_most_five,), given=goes),
    ],
    ids=lambda other: other.id,
)
def test_what_is_not_proved_of_all_runs_helps_nobody(other: Claim) -> None:
    assert fate(ABOVE_FIVE, STAYS, other).kind == UNDECIDED


def test_another_value_at_power_up_has_to_vanish_unseen() -> None:
    """Its step is that of the model, so that it steps alike says nothing."""
    assert fate("lit at power-up: True for False", DARK).kind == COUNTEREXAMPLE
    found = [examine(Subject([WASHED]), [m.number])[0] for m in mutants_of(Washed).mutants if m.power_up]
    kinds = {f"{f.mutant.was}: {f.mutant.change}": f.kind for f in found}
    assert kinds["mark at power-up: True for False"] == EQUIVALENT
    assert kinds["shown at power-up: True for False"] != EQUIVALENT
    assert kinds["n at power-up: 1 for 0"] != EQUIVALENT


class Washed(Model, event="tick"):
    """What `mark` holds at power-up is gone after a step, unseen; `shown` is seen, and `n` stays."""

    mark: Bit = power_up(False)
    shown: Bit = power_up(False)
    n: U2 = power_up(0)

    def step(self, go: Bit) -> tuple[Washed, Bit]:
        return Washed(mark=go, shown=go, n=select(go, self.n, self.n ^ 1)), self.shown


def follows(s: Seen) -> Bit:
    """Says little, of all registers."""
    return implies(s.mark & s.shown & (s.n == 3), s.shown)


WASHED = asked(follows, Washed, id="washed")


class Stopper(Model, event="tick"):
    """Counts to 5 and stays there."""

    n: U4 = power_up(0)

    def step(self) -> tuple[Stopper, Bit]:
        n = select(self.n == 5, self.n, (self.n + 1).low(4))
        return Stopper(n=n), self.n == 5


def at_most_ten(s: Seen) -> Bit:
    """True, and of little help."""
    return s.n <= 10


def at_most_three(s: Seen) -> Bit:
    """False: it comes to 5."""
    return s.n <= 3


def test_a_false_lemma_makes_nobody_equivalent() -> None:
    """Up to 3 it does not matter where the counter stops; in its runs it does."""
    claim = asked(at_most_ten, Stopper, id="false lemma", lemmas=(at_most_three,))
    found = fates(claim)
    assert found["(n == 5): 6 for 5"].kind == SLACK
    subject = Subject([claim])
    for fate in found.values():
        if fate.kind == EQUIVALENT:
            n = (system := single(subject.proved[0].problem, fate.mutant).system).state["n"]
            steps = [evaluate([n.next], {n.var: k}) for k in range(6)]
            assert (steps, system.state["n"].power_up) == ([[1], [2], [3], [4], [5], [5]], 0), fate


class Late(Model, event="tick"):
    """Comes to 50 and starts again."""

    n: U7 = power_up(0)

    def step(self, go: Bit) -> tuple[Late, Bit]:
        n = select(go, (self.n + 1).low(7), self.n)
        return Late(n=n), self.n == 50


def never_out(s: Seen) -> Bit:
    """False, after 51 steps."""
    return ~s.out


def any_number(s: Seen) -> Bit:
    """True of every register of this width."""
    return s.n <= 127


GOES = Scenario(51, {"go": True})


def test_a_twin_kills_where_it_is_proved() -> None:
    """At 51 it is refuted one step after the known run ends; where it never goes, it is proved."""
    twin = asked(never_out, Late, id="late", expect=REFUTED, twin_of="any", steps=5, scenario=GOES)
    claims = asked(any_number, Late, id="any"), twin
    assert fate("(n == 50): 51 for 50", *claims).kind not in KILLED
    assert fate("go: stuck at 0", *claims).kind == TWIN


def test_no_slack_where_a_proof_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    """A claim that is not proved keeps nobody's mutants: they are undecided, not slack."""
    monkeypatch.setattr(mutants, "decide", lambda problem, limits: Outcome(problem.claim, UNDECIDED))
    unproved = asked(three_or_less_is_dark, Climber, id="unproved", lemmas=(at_most_five,), induction=0)
    kinds = {f.kind for f in fates(unproved).values()}
    assert SLACK not in kinds
    assert UNDECIDED in kinds


def climbs_to_four(s: Seen) -> Bit:
    """Where it is at 4 and told to go, the lamp is dark."""
    return implies(s.n == 4, s.n <= 4)


def test_a_witness_that_shows_nothing_any_more_kills() -> None:
    """The claim is true of a climber that stands still, too; the run that is to reach its premise does not."""
    seen = asked(climbs_to_four, Climber, id="seen", witness=CLIMBS)
    found = fate("go: stuck at 0", seen)
    assert (found.kind, found.claim) == (VACUOUS, "seen")
    assert fate("go: stuck at 1", seen).kind == SLACK


def test_the_line_of_a_mutant(judged: dict[str, Fate]) -> None:
    lines, first = inspect.getsourcelines(Climber)
    for what, text in (("(n < 5): 6 for 5", "self.n < 5"), ("next lit: frozen", "lit now"), ("go: stuck at 0", "go &")):
        place = judged[what].mutant.place
        assert place is not None
        assert place.file == __file__
        assert text in lines[place.line - first]


def test_noting_ends() -> None:
    before = terms_graph.node
    with pytest.raises(ZeroDivisionError), terms_graph.noting(lambda term: 1 // 0):
        variable("x", uint(3))
    assert terms_graph.node is before


# --- the mutants themselves ------------------------------------------------------------------------------------------


def zoo() -> list[Term]:
    """A term of each operation that a model can be written with."""
    a, b, w, c = variable("a", uint(4)), variable("b", uint(4)), variable("w", uint(7)), variable("c", integer(-9, 9))
    p, q = variable("p", BIT), variable("q", BIT)
    whole = [
        a + b,
        a - b,
        a * b,
        a + 3,
        c + a,
        c - 2,
        a & b,
        a | b,
        a ^ b,
        w // 5,
        w % 5,
        w.slice(1, 3),
        (a + b).sat(4),
    ]
    whole += [(a - b).clip(-3, 3), a.concat(b), select(p, a, b), select(q, c, 2)]
    return [*whole, p & q, p | q, p ^ q, ~p, implies(p, q), a < b, a <= 9, a == b, w.bit(3), a.int() == c]


def test_the_zoo_has_every_operation_that_is_changed() -> None:
    from safety.terms.table import OPERATIONS

    met = {t.op for t in postorder(zoo())}
    assert OPERATIONS.keys() - met - TRANSPARENT == set()


def test_a_change_keeps_the_sort_and_differs_somewhere() -> None:
    random = Random(7)

    def value(v: Term) -> int | bool:
        return random.random() < 0.5 if v.sort == BIT else random.randint(*v.sort.bounds)

    for term in zoo():
        free = variables([term])
        for text, edit in edits(term):
            changed = edit(term.args)
            assert changed.sort == term.sort, text
            rows = [{v: value(v) for v in free} for _ in range(600)]
            assert any(evaluate([term], row) != evaluate([changed], row) for row in rows), (term, text)


def test_a_choice_gives_the_mutant_and_none_gives_the_model() -> None:
    mutants = mutants_of(Climber)
    as_written = Subject([TOP]).proved[0].as_written.system
    assert {s.path: s.next.uid for s in as_written.states} == {s.path: s.next.uid for s in trace(Climber).states}
    subject = Subject([TOP])
    number = next(m.number for m in mutants.mutants if str(m).endswith("(n < 5): 6 for 5"))
    changed = single(subject.proved[0].problem, mutants[number]).system
    n, go = changed.state["n"].var, changed.inputs["go"]
    assert evaluate([changed.state["n"].next], {n: 5, go: True}) == [6]
    assert SELECTOR not in changed.state


def test_a_replay_that_does_not_break_the_claim_is_refused() -> None:
    case = Subject([BELOW]).refuted[0]
    known = case.courses[0]
    confirmed(case.as_written, known, 5)
    with pytest.raises(Disagreement):
        confirmed(case.as_written, known, 4)


def test_a_solver_that_loses_the_mutants_difference_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: all steps are taken for the same; then mutants count as equivalent."""
    assert fate("(n < 5): 4 for 5", TOP).kind == SLACK
    monkeypatch.setattr(mutation_questions, "same_step", lambda *_: bit(True))
    assert fate("(n < 5): 4 for 5", TOP).kind == EQUIVALENT
