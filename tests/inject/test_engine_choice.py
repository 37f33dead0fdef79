"""Which engine runs a campaign, and what is said of it."""

from __future__ import annotations

import sys
from collections.abc import Callable
from fractions import Fraction
from types import ModuleType
from typing import Any

import pytest

from safety.faults import Fault, stuck
from safety.inject import Campaign
from safety.inject.engine import Batch, Outcome, engine_for
from safety.inject.lanes import LaneEngine
from safety.kinds import drift
from safety.system import Clock, ModelError, State, System
from safety.terms import select
from safety.terms.graph import BIT, TermError, node, uint, variable

Make = Callable[..., Campaign]


class Fits(LaneEngine):
    """In place of the native engine: one that takes the model."""

    name = "native"


def refuses(task: Any) -> None:
    raise TermError("no vector code for a number of 90 bits")


class Balks(Fits):
    """One that takes the model, but not a fault that has to be built in."""

    def run(self, batch: Batch) -> Outcome:
        if (batch.atoms == 0).any():
            raise TermError("fault0.lit.gone is u65")
        return super().run(batch)


@pytest.fixture
def native(monkeypatch: pytest.MonkeyPatch) -> Callable[[Any], None]:
    """Puts something in the place of the native engine; None: it is not installed."""

    def place(engine: Any) -> None:
        module = None
        if engine is not None:
            module = ModuleType("safety.inject.native")
            module.NativeEngine = engine  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, "safety.inject.native", module)  # type: ignore[arg-type]

    return place


def test_the_native_engine_is_taken_where_it_fits(campaign: Make, native: Callable[[Any], None]) -> None:
    native(Fits)
    entry = campaign(engine="auto").run()
    assert (entry["engine"], entry["engine_note"]) == ("native", "")


@pytest.mark.parametrize(("engine", "why"), [(None, "native"), (refuses, "no vector code for a number of 90 bits")])
def test_the_lanes_take_what_it_does_not_and_say_why(
    campaign: Make, native: Callable[[Any], None], engine: Any, why: str
) -> None:
    native(engine)
    entry = campaign(engine="auto").run()
    assert entry["engine"] == "lanes" and why in entry["engine_note"]
    with pytest.raises((ImportError, TermError), match=why):
        campaign(engine="native").run()


def test_the_lanes_take_a_fault_that_shows_only_in_the_run(campaign: Make, native: Callable[[Any], None]) -> None:
    native(Balks)
    found = campaign(engine="auto", collapsing=False)
    ticks: list[float] = []
    later = found.judged(1, 5)
    assert (found.engine_used, found.engine_note) == ("native", "")
    found.tick = ticks.append
    sooner = found.judged(0, 1)
    assert found.engine_used == "lanes" and "does not take it: fault0.lit.gone is u65" in found.engine_note
    plain = campaign(engine="lanes", collapsing=False).judged(0, 5)
    assert [*sooner.cells, *later.cells] == [*plain.cells]
    assert ticks[-1] == 1
    with pytest.raises(TermError, match="u65"):
        campaign(engine="native").run()


def test_a_slow_drift_of_a_wide_word_goes_to_the_lanes(campaign: Make) -> None:
    """A built-in kind counts beyond 64 bits at a word of 40; where LLVM is absent the lanes have it from the start."""
    read, given = variable("a", uint(40)), variable("x", BIT)
    seen = node("point", (read,), "p", read.sort)
    state = State(read, select(given, seen, read), 5)
    system = System("wide", Clock(event="t"), (state,), {"x": given}, {"p": seen}, {"p": seen}, {}, {})
    slow = [Fault(drift(Fraction(1, 28_800_000)), ["p"]), Fault(stuck(0, 0), ["p"])]
    told = {
        "model": system,
        "faults": slow,
        "stimulus": {"x": True},
        "start": {},
        "observe": {},
        "hazard": lambda wires: wires["p"] != 5,
        "wrong_side": None,
        "detected": None,
        "safe_side": None,
    }
    entries = [campaign(**told, engine=name).run() for name in ("auto", "lanes")]
    assert entries[0]["classes"] == entries[1]["classes"] and entries[0]["engine"] == "lanes"
    assert "does not take it" in entries[0]["engine_note"] and not entries[1]["engine_note"]


def test_what_no_engine_takes_stays_an_error(
    campaign: Make, native: Callable[[Any], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(self: LaneEngine, batch: Batch) -> Outcome:
        raise TermError("no engine takes this")

    native(Balks)
    monkeypatch.setattr(LaneEngine, "run", refuse)
    with pytest.raises(TermError, match="no engine takes this"):
        campaign(engine="auto").run()


def test_the_lanes_are_taken_when_asked_for(campaign: Make, native: Callable[[Any], None]) -> None:
    native(Fits)
    entry = campaign(engine="lanes").run()
    assert (entry["engine"], entry["engine_note"]) == ("lanes", "")


def test_an_unknown_engine_is_refused(campaign: Make) -> None:
    with pytest.raises(ModelError, match="engine 'nativ'; did you mean native"):
        engine_for(campaign().variant(0).task, "nativ")
