"""A claim's formula as the hazard of a campaign: the sentence that is proved is the one that is looked for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import pytest

from safety.faults import Fault, stuck
from safety.inject import Campaign, stuck_bits
from safety.model import Model, point, power_up
from safety.prove.claims import Seen, age, once, persists
from safety.prove.violation import happening, violation
from safety.system import ModelError
from safety.terms import U2, Bit, implies, select


class Lamp(NamedTuple):
    lit: Bit


class Button(Model, event="tick"):
    """A lamp is lit from the third tick on at which the button is down, as long as it is."""

    down: U2 = power_up(0)

    def step(self, press: Bit, test: Bit) -> tuple[Button, Lamp]:
        down = select(point("press", press), select(self.down < 3, (self.down + 1).low(2), self.down), 0)
        return Button(down=down), Lamp(lit=point("lit", (down == 3) | test))


def lights(s: Seen) -> Bit:
    """A button held for 3 ticks lights the lamp."""
    return implies(persists(s.press, ticks=3), s.lit)


def never_dark(s: Seen) -> Bit:
    """Once lit, the lamp never stays dark for 2 ticks."""
    return implies(once(s.lit), age(~s.lit, 2) < 2)


def button(hazard: Any, **changes: Any) -> Campaign:
    declared: dict[str, Any] = {
        "id": "button", "model": Button, "measured": 30, "faults": stuck_bits("*"), "hazard": hazard,
        "constant": {"test": False}, "stimulus": lambda frame: {"press": frame % 10 > 2}, "engine": "lanes",
    }  # fmt: skip
    return Campaign(**(declared | changes))


def found(campaign: Campaign) -> dict[str, str]:
    return {injection.id: cell for injection, cell in campaign.inject().injections()}


def test_a_fault_is_dangerous_when_the_claim_fails_in_its_run() -> None:
    assert found(button(violation(lights))) == {
        "press stuck-at-0": "wrong/no",
        "press stuck-at-1": "neutral/no",
        "lit stuck-at-0": "wrong/no",
        "lit stuck-at-1": "neutral/no",
    }


def test_the_signal_is_what_the_sentence_says() -> None:
    trace = button(violation(lights), faults=[Fault(stuck(0), ["lit"])]).replay(0).trace
    pressed = [k % 10 > 2 for k in range(30)]
    assert trace["observed hazard"] == [k >= 2 and all(pressed[k - 2 : k + 1]) for k in range(30)]


def test_a_hazard_is_where_its_formula_is_true() -> None:
    late = lambda s: persists(s.press, ticks=3) & ~s.lit  # noqa: E731
    assert found(button(happening(late))) == found(button(violation(lights)))


def test_formulas_share_their_registers_and_keep_their_own() -> None:
    both = button(violation(lights), watch={"again": violation(lights), "other": violation(never_dark)})
    alone = button(violation(lights))
    names = [s.path for s in both.system.states]
    assert len(names) == len(set(names)) == len(alone.system.states) + 2
    assert any("watch.age" in name for name in names)


@pytest.mark.parametrize(
    ("given", "dangerous"),
    [
        (lambda s: ~s.test, {"press stuck-at-0", "lit stuck-at-0"}),
        (lambda s: s.test, set()),
        (lambda s: ~s.press, set()),
    ],
)
def test_after_its_assumption_has_failed_a_claim_says_nothing(
    given: Callable[[Seen], Bit], dangerous: set[str]
) -> None:
    cells = found(button(violation(lights, given)))
    assert {name for name, cell in cells.items() if cell == "wrong/no"} == dangerous


def test_a_signal_that_is_not_there_is_named() -> None:
    with pytest.raises(ModelError, match="has no signal 'lid'"):
        button(violation(lambda s: s.lid)).inject()
