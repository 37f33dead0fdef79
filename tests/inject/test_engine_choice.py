"""Which engine runs a campaign, and what is said of it."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import ModuleType
from typing import Any

import pytest

from safety.inject import Campaign
from safety.inject.engine import engine_for
from safety.inject.lanes import LaneEngine
from safety.system import ModelError
from safety.terms.graph import TermError

Make = Callable[..., Campaign]


class Fits(LaneEngine):
    """In place of the native engine: one that takes the model."""

    name = "native"


def refuses(task: Any) -> None:
    raise TermError("no vector code for a number of 90 bits")


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


def test_the_lanes_are_taken_when_asked_for(campaign: Make, native: Callable[[Any], None]) -> None:
    native(Fits)
    entry = campaign(engine="lanes").run()
    assert (entry["engine"], entry["engine_note"]) == ("lanes", "")


def test_an_unknown_engine_is_refused(campaign: Make) -> None:
    with pytest.raises(ModelError, match="engine 'nativ'; did you mean native"):
        engine_for(campaign().variant(0).task, "nativ")
