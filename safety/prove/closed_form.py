"""Many steps at once: what the sums of registers say of a few sampled steps, whatever happens in between.

Summed over h steps in a row, `x' = x + flow - modulus * [carry]` reads

    x(end) = x(begin) + (sum of the flow) - modulus * (number of carries),

linear, with the flow between h times its least and h times its greatest value.  So nothing is unrolled: the steps
sampled are the first, the last, and those before and after the first few and the last few events of one carry, the
*clock*; how many steps lie between them is left open.  Every run satisfies this; so if nothing does, there is no run.
Satisfying values are no run: between samples, registers may be anywhere.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from safety.prove.flows import ONE, Product, Sum
from safety.prove.solve import Solver
from safety.terms.smt import solver_module

CASES = 4  # a number that keeps its value, times a count: cases up to this count, bounds above


@dataclass(frozen=True)
class Accumulator:
    """`weights` (by uid of the register) times registers, within `low` and `high`.

    A step changes it by `change` (`relation` ==), by that or more (>=), or by that or less (<=).  It stays less than
    each of `below`: a factor times a number.
    """

    weights: Mapping[int, int]
    change: Sum
    relation: str
    low: int
    high: int
    below: tuple[tuple[int, int], ...] = ()

    @property
    def whole(self) -> bool:
        """Whether it moves by counted events only; other accumulators are relaxed to fractions."""
        return all(bits for bits, _ in self.change)


@dataclass(frozen=True)
class ClosedForm:
    """`steps` steps in a row: the accumulators, bounds of each number, sums of flows with their least value a step.

    `steady` are the numbers that have the same value in all steps.
    """

    steps: int
    accumulators: tuple[Accumulator, ...]
    numbers: Mapping[int, tuple[int, int]]
    rates: tuple[tuple[Sum, int], ...]
    steady: frozenset[int]

    def clock(self) -> tuple[Product, int] | None:
        """A carry that comes at least so often, whatever happens; None where there is none.

        It wraps an accumulator into which something flows at every step.
        """
        for x in self.accumulators:
            carries = [(product, -c) for product, c in x.change.items() if product[0]]
            flow = {product: c for product, c in x.change.items() if not product[0]}
            if x.relation == "==" and len(carries) == 1 and carries[0][0][1] is None and carries[0][1] > 0:
                least = sum(c * (1 if n is None else self.numbers[n][c < 0]) for (_, n), c in flow.items())
                (event, modulus), *_ = carries
                often = (least * self.steps - (x.high - x.low)) // modulus
                if least > 0 and often > 0:
                    return event, often
        return None


class Question:
    """The samples of a closed form as constraints of one solver."""

    def __init__(self, form: ClosedForm, solver: str, timeout: float) -> None:
        self.form, self.k = form, solver_module(solver)
        self.solver = Solver(solver, self.k, timeout)
        self._made = 0
        self._steady = {n: self._variable(True, *form.numbers[n]) for n in sorted(form.steady)}

    def check(self) -> str:
        """unsat: no run of so many steps satisfies what was added."""
        return self.solver.check()

    def sample(self) -> list[Any]:
        """The accumulators at some step."""
        values = []
        for x in self.form.accumulators:
            value = self._variable(x.whole, x.low, x.high)
            self.solver.add(*(value <= factor * self._steady[n] - 1 for factor, n in x.below))
            values.append(value)
        return values

    def steps(self, begin: Sequence[Any], steps: Any, fixed: Mapping[Product, Any], many: bool = False) -> list[Any]:
        """The sample some steps after `begin`, with the counts of some products `fixed`.

        `many`: so many that the cases of a steady number are not worth telling apart.
        """
        amounts = self._amounts(steps, fixed, many)
        end = self.sample()
        for x, before, after in zip(self.form.accumulators, begin, end, strict=True):
            reached = before + sum(c * amounts[product] for product, c in x.change.items())
            self.solver.add({"==": after == reached, ">=": after >= reached, "<=": after <= reached}[x.relation])
        for flow, least in self.form.rates:
            self.solver.add(sum(c * amounts[product] for product, c in flow.items()) >= least * steps)
        return end

    def several(self) -> Any:
        """Some number of steps."""
        return self._variable(False, 0, self.form.steps)

    def count(self) -> Any:
        """Some number of events."""
        return self._variable(True, 0, self.form.steps)

    def _amounts(self, steps: Any, fixed: Mapping[Product, Any], many: bool) -> dict[Product, Any]:
        """For each product that occurs, how much of it there is in these steps."""
        wanted = {p: None for x in self.form.accumulators for p in x.change}
        wanted |= {p: None for flow, _ in self.form.rates for p in flow}
        amounts: dict[Product, Any] = {ONE: steps, **fixed}
        for bits, number in wanted:
            events = (bits, None)
            if bits and events not in amounts:
                amounts[events] = self.count()
                self.solver.add(amounts[events] <= steps)
            if number is not None:
                amounts[bits, number] = self._carried(number, amounts[events] if bits else steps, bool(bits), many)
        return amounts

    def _carried(self, number: int, times: Any, counted: bool, many: bool) -> Any:
        """The sum of a number over so many steps."""
        total = self._variable(counted)
        low, high = self.form.numbers[number]
        self.solver.add(total >= low * times, total <= high * times)
        if number in self._steady and counted and not many:
            value = self._steady[number]
            cases = [self.k.And(times == n, total == n * value) for n in range(CASES)]
            more = [times >= CASES]  # what more of them add up to is known where all have one sign
            if low >= 0:
                more.append(total >= CASES * value)
            elif high <= 0:
                more.append(total <= CASES * value)
            self.solver.add(self.k.Or(*cases, self.k.And(*more)))
        return total

    def _variable(self, whole: bool, low: int | None = None, high: int | None = None) -> Any:
        self._made += 1
        x = (self.k.Int if whole else self.k.Real)(f"x{self._made}")
        if low is not None and high is not None:
            self.solver.add(x >= low, x <= high)
        return x


def excluded(form: ClosedForm, clock: Product, ends: int, solver: str, timeout: float) -> str:
    """unsat: no run has so many steps.  Sampled around the first and the last `ends` events of the clock."""
    ask = Question(form, solver, timeout)
    now, taken = ask.sample(), []
    for event in range(2 * ends):
        middle = event == ends
        taken.append(ask.several())
        now = ask.steps(now, taken[-1], {clock: ask.count() if middle else 0}, middle)
        now = ask.steps(now, 1, {clock: 1})
    taken.append(ask.several())
    ask.steps(now, taken[-1], {clock: 0})
    ask.solver.add(sum(taken) + 2 * ends == form.steps)
    return ask.check()


def too_few(form: ClosedForm, clock: Product, events: int, solver: str, timeout: float) -> str:
    """unsat: in so many steps the clock has at least so many events."""
    ask = Question(form, solver, timeout)
    count = ask.count()
    ask.solver.add(count <= events - 1)
    ask.steps(ask.sample(), form.steps, {clock: count}, many=True)
    return ask.check()
