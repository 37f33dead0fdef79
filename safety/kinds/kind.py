"""What a fault kind is, and what its effect is built from.

| place  | the fault acts on                   | its effect is                                                       |
|--------|-------------------------------------|---------------------------------------------------------------------|
| point  | each of its points alone            | `effect(seat, healthy)`: the value seen                             |
| points | all of its points together          | `joint(seat, healthy)`: the values seen, in the order of the points |
| part   | the registers of parts of the model | `update(seat, part)`: their next values                             |
| group  | what its `members` act on           | that of each member                                                 |

An effect is a pure function: from terms it makes terms, with registers and free choices that it asks its seat for.  It
says what happens while the fault acts; at other steps the healthy value passes.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, cast

from safety.system import ModelError, PowerUpValue, State, substitute
from safety.terms import Bit
from safety.terms.graph import BIT, Sort, Term, Value, variable
from safety.terms.values import build, const

POINT, POINTS, PART, GROUP = "point", "points", "part", "group"
ANY_SORT = ("bit", "uint", "int", "real")
WIRES = ("bit", "uint")
NUMBERS = ("uint", "int", "real")

Draw = Callable[[str, int], Value]  # from the name of a point and the number of a step
Bits = int | Iterable[int] | None


class Seat:
    """What a fault's effect is built from: whether it acts now, memory, and free choices."""

    def __init__(self, name: str, active: Bit) -> None:
        self.name, self.active = name, active
        self.states: list[State] = []
        self.inputs: dict[str, Term] = {}
        self.draws: dict[str, Draw] = {}

    def register(self, label: str, sort: Sort, start: PowerUpValue) -> Term:
        """A register of the fault; give its next value with `then`."""
        var = variable(f"{self.name}.{label}", sort)
        self.states.append(State(var, var, start))
        return var

    def then(self, register: Term, value: Term) -> None:
        """The register's next value.  Raises `ModelError` for one that this seat has not."""
        position = next((i for i, s in enumerate(self.states) if s.var is register), None)
        if position is None:
            raise ModelError(f"{self.name} has no register {register!r}; ask for it with seat.register(...) first")
        self.states[position] = State(register, value, self.states[position].power_up)

    def free(self, label: str, sort: Sort, draw: Draw | None = None) -> Term:
        """A value chosen anew at every step: in a proof by the solver, in a run by its schedule.

        What the schedule does not say, `draw` chooses from the name of the point and the number of the step; without
        it the value is 0 or false.  So the choice of a run is always one of those that a proof allows.
        """
        name = f"{self.name}.{label}"
        self.inputs[name] = variable(name, sort)
        if draw is not None:
            self.draws[name] = draw
        return self.inputs[name]

    def only_while(self, condition: Bit) -> Seat:
        """The same seat for an effect that acts only while a condition holds too."""
        narrower = copy.copy(self)
        narrower.active = self.active & condition
        return narrower

    def at(self, place: str) -> Seat:
        """The seat of the same fault at another place: what it asks for is called after that."""
        other = copy.copy(self)
        other.name = f"{self.name.partition('.')[0]}.{place}"
        return other


@dataclass(frozen=True)
class Part:
    """Registers that a fault acts on, each with its healthy next value; parameters are not among them."""

    states: tuple[State, ...]

    def after(self, steps: int) -> tuple[Term, ...]:
        """Their values after so many steps at once; what lies outside the part stays as it is at this step."""
        values: tuple[Term, ...] = tuple(s.var for s in self.states)
        for _ in range(steps):
            held = {s.var.uid: value for s, value in zip(self.states, values, strict=True)}
            values = tuple(substitute([s.next for s in self.states], held))
        return values


Effect = Callable[[Seat, Term], Term]
Joint = Callable[[Seat, tuple[Term, ...]], tuple[Term, ...]]
Update = Callable[[Seat, Part], tuple[Term, ...]]


def _nowhere(_: Seat, healthy: Term) -> Term:
    raise ModelError(f"this fault acts on more than one point: build it into the system, not at {healthy!r} alone")


@dataclass(frozen=True)
class Kind:
    """A way to fail: name, meaning in one line, its effect while active, the sorts of value that it applies to.

    Exactly one of `effect`, `joint`, `update` and `members` is given (see the top of this file).  `at_once` is the
    least and the greatest number of points that a joint effect takes.  `unit`: of the parameters; `reference`: where
    IEC 61508 or EN 50129 names this fault, empty where we know of no such place.
    """

    name: str
    meaning: str
    effect: Effect = _nowhere
    sorts: tuple[str, ...] = ANY_SORT
    joint: Joint | None = None
    update: Update | None = None
    members: tuple[tuple[str, Kind], ...] = ()
    at_once: tuple[int, int | None] = (2, None)
    unit: str = ""
    reference: str = ""

    def __post_init__(self) -> None:
        ways = (self.effect is not _nowhere, self.joint, self.update, self.members)
        if sum(map(bool, ways)) != 1:
            raise ModelError(f"kind {self.name!r}: give it one of effect, joint, update and members")

    @property
    def place(self) -> str:
        """What it acts on: "point", "points", "part" or "group"."""
        return POINTS if self.joint else PART if self.update else GROUP if self.members else POINT

    def __str__(self) -> str:
        return self.name


def mask(sort: Sort, bits: Bits, what: str) -> int:
    """The bits of a point as a number; None means all of them.  Raises `ModelError` for bits that it has not."""
    if bits is None:
        return int(sort.bounds[1])
    if sort == BIT:
        raise ModelError(f"{what} at a wire: it has no bits to choose from; leave the bit out")
    found = 0
    for number in listed(bits):
        if not 0 <= number < sort.width:
            raise ModelError(f"{what}: a point of {sort} has bits 0..{sort.width - 1}, not bit {number}")
        found |= 1 << number
    return found


def listed(bits: int | Iterable[int]) -> list[int]:
    """Bit numbers in a list.  Raises `ModelError` for none, for one named twice, or for what is no number."""
    numbers = list(bits) if isinstance(bits, Iterable) else [bits]
    if not numbers or any(type(n) is not int for n in numbers) or len(set(numbers)) < len(numbers):
        raise ModelError(f"bits {bits!r}: name each bit once, by its number, 0 the lowest")
    return numbers


def at_bits(bits: Bits) -> str:
    """The bits as part of a name: ` bit 3`, ` bits 0+2`, or nothing for all of them."""
    numbers = [] if bits is None else listed(bits)
    return f" bit{'s' if len(numbers) > 1 else ''} {'+'.join(map(str, numbers))}" if numbers else ""


def whole(value: object, least: int, call: str, what: str) -> int:
    """A parameter that is a whole number of steps, pulses or the like; `ModelError` otherwise."""
    if type(value) is not int or value < least:
        raise ModelError(f"{call}: {what}; write a whole number from {least} up")
    return value


def resting(sort: Sort) -> Any:
    """The value of a point without power or before the first step: 0 or false, or the least that there is."""
    return False if sort == BIT else 0 if sort.admits(0) else sort.bounds[0]


def choose(condition: Bit, then: Term, otherwise: Term) -> Term:
    """`then` where the condition holds, of any sort.

    Where `then` masks `otherwise`, the mask is chosen: the stuck bits of a word stay a flat chain, which solvers need.
    """
    if then.op in _NEUTRAL and then.args[0] is otherwise and then.args[1].is_const:
        neutral = const(_NEUTRAL[then.op](then.sort), then.sort)
        chosen = build("select", (condition, then.args[1], neutral), None, then.sort)
        return build(then.op, (otherwise, chosen), None, then.sort)
    return build("select", (condition, then, otherwise), None, then.sort)


_NEUTRAL: dict[str, Callable[[Sort], int]] = {
    "bor": lambda _: 0, "bxor": lambda _: 0, "band": lambda sort: int(sort.bounds[1]),
}  # fmt: skip


def exact(value: Any, sort: Sort, what: str) -> Value:
    """A parameter as a value of a point's sort (for a wire 0 and 1 do); `ModelError` where it is none."""
    if sort == BIT and value in (0, 1):
        return bool(value)
    if not sort.admits(value):
        raise ModelError(f"{what}: {value!r} is not a value of {sort}")
    return cast(Value, value)
