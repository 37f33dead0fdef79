"""What is chosen of faults: in a run by their schedules, in a proof within a budget."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from safety.faults.budget import Budget
from safety.faults.instrument import Faulted, now_name, present_name
from safety.system import ModelError
from safety.terms import Bit, count
from safety.terms.graph import BIT, Sort
from safety.terms.values import bit


def within(budget: Budget, faulted: Faulted) -> Bit:
    """The budget as a condition on which faults are present."""
    if budget.most is None or budget.most >= len(faulted.faults):
        return bit(True)
    return count(*faulted.present) <= budget.most if faulted.present else bit(True)


def schedule(faulted: Faulted) -> Callable[[int], dict[str, Any]]:
    """The free choices of a run, step by step: onsets from each fault's `at` and `ticks`, values from its `values`.

    Where these say nothing, a kind that draws its values (noise) draws; else it is 0 or false.  Raises `ModelError` for
    values at a place where the fault leaves no choice.
    """
    usual = {name: _least(faulted.system.inputs[name].sort) for name in faulted.choices}
    timed = {now_name(i): fault for i, fault in enumerate(faulted.faults) if now_name(i) in usual}
    given: dict[str, Sequence[Any]] = {}
    for i, fault in enumerate(faulted.faults):
        for place, sequence in (fault.values or {}).items():
            names = [f"{present_name(i)}.{place}.{label}" for label in ("value", "power_up")]
            chosen = [name for name in names if name in usual]
            if not chosen or not sequence:
                raise ModelError(
                    f"fault {fault.name!r} has values for {place!r}, where it chooses none; leave them out"
                )
            given |= dict.fromkeys(chosen, sequence)
    draws = {name: draw for name, draw in faulted.draws.items() if name not in given}

    def choices(step: int) -> dict[str, Any]:
        now = {name: fault.acts(step) for name, fault in timed.items()}
        drawn = {name: draw(step) for name, draw in draws.items()}
        said = {name: sequence[min(step, len(sequence) - 1)] for name, sequence in given.items()}
        return usual | now | drawn | said

    return choices


def _least(sort: Sort) -> bool | int:
    return False if sort == BIT else sort.low or 0
