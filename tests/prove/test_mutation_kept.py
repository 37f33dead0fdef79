"""Kills of an earlier run: run again they count, and what they do not kill any more is examined as if new."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import pytest

from safety.faults import Fault, at_most
from safety.faults.fault import TRANSIENT
from safety.kinds import power_dip
from safety.model import Model, power_up
from safety.prove import mutants
from safety.prove.cache import Cache
from safety.prove.claims import Claim, Scenario, Seen
from safety.prove.mutants import COUNTEREXAMPLE, EQUIVALENT, KILLED, VACUOUS, Fate, examine
from safety.prove.mutation_case import Case, Subject
from safety.prove.mutation_drive import Drive
from safety.prove.mutation_kept import Kills
from safety.prove.mutation_questions import Split
from safety.terms import U2, U3, Bit, Real, implies, select
from tests.prove.small import asked


class Lamp(NamedTuple):
    on: Bit


class Climber(Model, event="tick"):
    """Climbs to 5 while told to, and lights a lamp there."""

    n: U3 = power_up(0)

    def step(self, go: Bit) -> tuple[Climber, Lamp]:
        n = select(go & (self.n < 5), (self.n + 1).low(3), self.n)
        return Climber(n=n), Lamp(on=self.n == 5)


def stays_low(s: Seen) -> Bit:
    """It stays at 5, where the lamp is."""
    return (s.n <= 5) & (s.on == (s.n >= 5))


def lit_at_the_top(s: Seen) -> Bit:
    """Where it is at 5 the lamp is on."""
    return implies(s.n == 5, s.on)


CLIMBS = Scenario(12, {"go": True})
LOW = asked(stays_low, Climber, id="low", lemmas=(stays_low,), witness=CLIMBS)
TOP = asked(lit_at_the_top, Climber, id="top", witness=CLIMBS)


@pytest.fixture
def cache(tmp_path: Path) -> Cache:
    return Cache(tmp_path, lambda text: pytest.fail(text))


def examined(cache: Cache, *claims: Claim) -> dict[str, Fate]:
    subject = Subject(claims, timeout=4.0)
    found = examine(subject, range(1, len(subject.mutants.mutants) + 1), Kills(cache, subject.mutants))
    return {f"{f.mutant.was}: {f.mutant.change}": f for f in found}


def again(cache: Cache, text: str, *claims: Claim) -> list[str]:
    """The claims that kill a mutant by what is kept of it."""
    subject = Subject(claims)
    (number,) = [m.number for m in subject.mutants.mutants if f"{m.was}: {m.change}" == text]
    kills = Kills(cache, subject.mutants)
    kills.recall([number])
    return [case.claim.id for case in subject.proved if kills.again(case, {number})]


def test_what_was_killed_is_killed_again_without_a_search(cache: Cache, monkeypatch: pytest.MonkeyPatch) -> None:
    first = examined(cache, LOW, TOP)
    kinds = {fate.kind for fate in first.values()}
    assert {COUNTEREXAMPLE, VACUOUS} <= kinds
    searched: set[int] = set()
    whole = Drive.broken

    def seen(drive: Drive, some, seconds: float, patience: int):  # type: ignore[no-untyped-def]
        searched.update(m.number for m in some)
        return whole(drive, some, seconds, patience)

    monkeypatch.setattr(Drive, "broken", seen)
    second = examined(cache, LOW, TOP)
    assert second == first
    assert not searched & {f.mutant.number for f in first.values() if f.kind in KILLED}
    assert searched


def test_another_claim_of_the_same_name_is_put_to_all_anew(cache: Cache) -> None:
    examined(cache, LOW)
    assert again(cache, "(n < 5): <= for <", LOW) == ["low"]
    weaker = asked(lambda s: s.n <= 7, Climber, id="low", witness=CLIMBS)
    assert again(cache, "(n < 5): <= for <", weaker) == []
    other = asked(stays_low, Climber, id="other", lemmas=(stays_low,))
    assert again(cache, "(n < 5): <= for <", other) == []


def test_another_model_of_the_same_text_is_examined_anew(cache: Cache) -> None:
    """Here the lamp alone is as it was; the climber stops at 5 in another way too."""

    class Climber(Model, event="tick"):
        """Climbs to 5 while told to, and never on from there."""

        n: U3 = power_up(0)

        def step(self, go: Bit) -> tuple[Climber, Lamp]:
            n = select(go & (self.n < 5) & (self.n != 5), (self.n + 1).low(3), self.n)
            return Climber(n=n), Lamp(on=self.n == 5)

    examined(cache, LOW)
    same = asked(stays_low, Climber, id="low", lemmas=(stays_low,), witness=CLIMBS)
    assert again(cache, "(n < 5): <= for <", same) == []
    assert again(cache, "(n + 1): - for +", same) == ["low"]
    assert examined(cache, same)["(n < 5): <= for <"].kind == EQUIVALENT


@pytest.mark.parametrize(
    "given",
    [
        {"start": {}, "inputs": {"go": [[True, 12]], "gone": [[1, 12]]}},
        {"start": {}, "inputs": {}},
        {"start": {"gone": 3}, "inputs": {"go": [[True, 12]]}},
        {"start": {"n": 7}, "inputs": {"go": [[True, 12]]}},  # not open at power-up
        {"start": {}, "inputs": {"go": [[9, 12]]}},
        {"start": {}, "inputs": {"go": [[True, 3]]}},
        {"start": {}, "inputs": {"go": [[False, 12]]}},  # a run that breaks nothing
    ],
)
def test_a_run_that_does_not_fit_kills_nobody(cache: Cache, given: object) -> None:
    examined(cache, LOW)
    subject = Subject([LOW])
    kills = Kills(cache, subject.mutants)
    (number,) = [m.number for m in subject.mutants.mutants if f"{m.was}: {m.change}" == "(n < 5): <= for <"]
    record = cache.get(kills.keys[number])
    cache.put(kills.keys[number], record | {"steps": 12, "given": given})
    assert again(cache, "(n < 5): <= for <", LOW) == []
    cache.put(kills.keys[number], record)
    assert again(cache, "(n < 5): <= for <", LOW) == ["low"]


class Level(Model, event="tick"):
    """Follows an exact height."""

    high: Bit = power_up(False)

    def step(self, x: Real) -> tuple[Level, Bit]:
        return Level(high=x > 2), self.high


def test_exact_numbers_are_kept(cache: Cache) -> None:
    exact = asked(lambda s: s.out == s.high, Level, id="exact", given=lambda s: s.x * 3 == 7)
    found = examined(cache, exact)["high: stuck at 1"]
    assert (found.kind, found.claim) == (COUNTEREXAMPLE, "exact")
    assert again(cache, "high: stuck at 1", exact) == ["exact"]


def test_a_solver_that_names_a_mutant_falsely_kills_nobody(cache: Cache, monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: the search says of each mutant that it breaks the claim; the replay knows better."""
    brittle = asked(lambda s: s.n != 7, Climber, id="brittle", lemmas=(stays_low,))
    monkeypatch.setattr(
        mutants, "breakable", lambda some, target, numbers, *_: Split(failed=dict.fromkeys(numbers, "lies"))
    )
    found = examined(cache, brittle)["(n < 5): <= for <"]  # it comes to 6 and stays
    assert found.kind not in KILLED


# --- power that fails -------------------------------------------------------------------------------------------------


class Settles(Model, event="tick"):
    """What it holds at power-up is gone after a step, unseen at power-up."""

    mark: Bit = power_up(False)
    age: U2 = power_up(0)

    def step(self, go: Bit) -> tuple[Settles, Bit]:
        return Settles(mark=go & ~go, age=select(self.age < 3, (self.age + 1).low(2), self.age)), self.mark & (
            self.age == 3
        )


MARK = "mark at power-up: True for False"
DIP = Fault(power_dip(), "mark", TRANSIENT, ticks=1, name="dip")


def never_out(s: Seen) -> Bit:
    """Late there is no mark."""
    return ~s.out


def marked(*claims: Claim) -> Fate:
    subject = Subject(claims, timeout=4.0)
    return examine(subject, [m.number for m in subject.mutants.mutants if f"{m.was}: {m.change}" == MARK])[0]


def test_a_value_at_power_up_comes_back_with_the_power() -> None:
    """Without faults it is equivalent; a claim under which the power may fail is broken by a dip."""
    calm = asked(never_out, Settles, id="calm")
    assert marked(calm).kind == EQUIVALENT
    dips = asked(never_out, Settles, id="dips", faults=at_most(1, [DIP]))
    found = marked(calm, dips)
    assert (found.kind, found.claim) == (COUNTEREXAMPLE, "dips"), found
    other = replace(dips, id="other", faults=at_most(1, [replace(DIP, points=["age"])]))
    assert marked(calm, other).kind == EQUIVALENT  # there the power of another register fails


def test_a_dip_that_is_taken_for_the_models_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: nobody says that the fault brings the value back; then the mutant counts as equivalent."""
    monkeypatch.setattr(Case, "restarting", set())
    assert marked(asked(never_out, Settles, faults=at_most(1, [DIP]))).kind == EQUIVALENT
