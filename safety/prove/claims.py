"""Claims: a property of a model, the faults it must withstand, and the verdict that is expected of it.

    @claim(Ts7, faults=at_most(1, "channel"), requirement="TS7-7", source="[P] 1.6", expect=PROVED)
    def brakes_on_overspeed(s: Seen) -> Bit:
        \"\"\"With one channel broken in any way, overspeed for 288 steps gives the brake.\"\"\"
        return implies(persists(s.excess >= 8, ticks=288), s.brake)

A claim that must fail says so (`expect=REFUTED`); one that does not fail then is a failure of the suite.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Any, TypeVar, cast

from safety.faults import Budget, Faulted
from safety.model import Model
from safety.system import OUTPUT, ModelError, State, System, nearest
from safety.terms import Bit, Term, UInt, select, word
from safety.terms.graph import BIT, describe, uint, variable
from safety.terms.values import any_of, bit

PROVED, BOUNDED, VACUOUS, REFUTED, UNDECIDED = "proved", "bounded", "vacuous", "refuted", "undecided"
VERDICTS = (PROVED, BOUNDED, VACUOUS, REFUTED, UNDECIDED)
INTEGERS, BITS = "integers", "bits"

Formula = Callable[["Seen"], Bit]
F = TypeVar("F", bound=Callable[..., Any])


@dataclass(frozen=True)
class Scenario:
    """A scripted run, as a candidate for a counterexample or as the witness that a premise can happen.

    `inputs` and `values` (free values of faulty points, by point) are constants or functions of the step; what is not
    named is 0 or false.  `present` names the faults that are in the equipment, `at` the step of their onset.
    """

    steps: int
    inputs: Mapping[str, Any] = field(default_factory=dict)
    start: Mapping[str, Any] = field(default_factory=dict)
    present: Sequence[str] = ()
    values: Mapping[str, Any] = field(default_factory=dict)
    at: int = 0


@dataclass(frozen=True)
class Claim:
    """One claim, as declared.  `id` is the proof file's stem and the function's name."""

    id: str
    model: type[Model]
    formula: Formula
    statement: str
    expect: str
    requirement: str = ""
    source: str = ""
    faults: Budget | None = None
    given: Formula | None = None
    start: Formula | None = None
    lemmas: tuple[Formula, ...] = ()
    symbolic: tuple[str, ...] = ()
    settings: Mapping[str, Any] = field(default_factory=dict)
    steps: int = 20
    induction: int = 1
    arithmetic: str = INTEGERS
    scenario: Scenario | None = None
    witness: Scenario | None = None
    twin_of: str | None = None
    role: str = "claim"
    anywhere: bool = False
    refinement: Any = None
    steps_per_frame: int = 1

    @property
    def own_parameters(self) -> Mapping[str, Any]:
        """The parameters that the claim itself sets, or leaves open (None)."""
        return {**self.settings, **dict.fromkeys(self.symbolic)}


_registry: dict[str, Claim] = {}


def registered() -> list[Claim]:
    """All claims that imported proof files have declared, in order."""
    return list(_registry.values())


def register(new: Claim) -> None:
    """Add a claim; raises `ModelError` when the id is taken by another function.

    A file that is read again (its functions have new globals, or stand where they stood) replaces its claims.
    """
    old = _registry.get(new.id)
    if old is not None and old.formula is not new.formula:
        a, b = old.formula, new.formula
        again = a.__code__.co_filename == b.__code__.co_filename and (
            a.__code__.co_firstlineno == b.__code__.co_firstlineno or a.__globals__ is not b.__globals__
        )
        if not again:
            raise ModelError(f"two claims are called {new.id!r}; rename one")
    _registry[new.id] = new


def claim(
    model: type[Model],
    *,
    expect: str,
    requirement: str = "",
    source: str = "",
    faults: Budget | None = None,
    given: Formula | None = None,
    start: Formula | None = None,
    lemmas: Sequence[Formula] = (),
    symbolic: Sequence[str] = (),
    settings: Mapping[str, Any] | None = None,
    steps: int = 20,
    induction: int = 1,
    arithmetic: str = INTEGERS,
    scenario: Scenario | None = None,
    witness: Scenario | None = None,
    twin_of: Callable[..., Any] | None = None,
    defeat: bool = False,
    anywhere: bool = False,
    steps_per_frame: int = 1,
) -> Callable[[F], F]:
    """Declare a claim about a model.

    `given` holds at every step and `start` at power-up (both are shown as assumptions); with `anywhere` the claim
    starts from every register content that `start` admits, not from power-up.  `lemmas` are invariants of the
    registers, proved along with the claim and counted; `symbolic` parameters are left open in their range.  `steps`
    bounds the search for counterexamples, `induction` the depth of induction.  With `steps_per_frame` so many steps of
    the model are one step of the claim: inputs are held, signals are those of the last.  `scenario` is a scripted
    counterexample, `witness` a run in which the premise happens.  A `defeat` is refuted because the equipment falls
    short, not because the sentence was made too strong: reports put it first.
    Raises `ModelError` for an unknown verdict or arithmetic, a bound below what it can be, or a claim without a
    statement (docstring).
    """
    if arithmetic not in (INTEGERS, BITS):
        raise ModelError(f"arithmetic={arithmetic!r}; it is INTEGERS or BITS")
    for name, value, least in (
        ("steps", steps, 1),
        ("induction", induction, 0),
        ("steps_per_frame", steps_per_frame, 1),
    ):
        if type(value) is not int or value < least:
            raise ModelError(f"{name}={value!r}; it is a whole number from {least} up")
    if expect not in VERDICTS:
        raise ModelError(f"expect={expect!r}; it is one of {', '.join(VERDICTS)}")

    def declare(formula: F) -> F:
        statement = " ".join((formula.__doc__ or "").split())
        if not statement:
            raise ModelError(f"claim {formula.__name__} says nothing: give it a docstring in plain words")
        role = "defeat" if defeat else "twin" if twin_of else "claim"
        register(
            Claim(
                claim_id(formula), model, formula, statement, expect, requirement, source, faults, given, start,
                tuple(lemmas), tuple(symbolic), dict(settings or {}), steps, induction, arithmetic, scenario, witness,
                claim_id(twin_of) if twin_of else None, role, anywhere, steps_per_frame=steps_per_frame,
            )
        )  # fmt: skip
        return formula

    return declare


def claim_id(formula: Callable[..., Any]) -> str:
    """`proof file's stem . function`, e.g. `ts7_voting.brakes_on_overspeed`."""
    return f"{formula.__module__.rsplit('.', 1)[-1]}.{formula.__name__}"


# --- what a claim sees ---------------------------------------------------------------------------------------------


class Seen:
    """The signals of a system by name: `s.brake`, `s.a.u`, `s["a.u"]`; registers are read before the step."""

    def __init__(self, system: System, faulted: Faulted | None = None, prefix: str = "") -> None:
        self._system, self._faulted, self._prefix = system, faulted, prefix

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return self[name]

    def __getitem__(self, name: str) -> Any:
        path = self._prefix + name
        names = self._system.names()
        if path + OUTPUT in names:
            raise ModelError(
                f"{self._system.name} has an input and an output {path!r}; write s[{path + OUTPUT!r}] for the output"
            )
        if path in names:
            return self._system.lookup(path)
        if any(n.startswith(path + ".") for n in names):
            return Seen(self._system, self._faulted, path + ".")
        raise ModelError(f"{self._system.name} has no signal {path!r}; {nearest(path, names)}")


# --- what a claim can say of the faults in it ------------------------------------------------------------------------


def faulty(s: Seen, part: str = "") -> Bit:
    """Whether a fault that acts in a part (or anywhere in what `s` shows) is in the equipment, now or later.

    Raises `ModelError` for a part that does not exist.
    """
    found = _faulted(s)
    prefix = f"{s._prefix}{part}." if part else s._prefix
    if not any(path.startswith(prefix) for path in s._system.names()):
        raise ModelError(f"{s._system.name} has no part {prefix[:-1]!r}; {nearest(prefix[:-1], s._system.parts)}")
    return any_of(
        *(b for b, at in zip(found.present, found.where, strict=True) if any(p.startswith(prefix) for p in at))
    )


def has(s: Seen, *names: str) -> Bit:
    """Whether one of these faults is in the equipment, now or later."""
    return _named(s, names, lambda f: f.present)


def struck(s: Seen, *names: str) -> Bit:
    """Whether one of these faults acted before this step (a register, so lemmas can read it)."""
    return _named(s, names, lambda f: f.acted)


def new_fault(s: Seen) -> Bit:
    """Whether any fault begins to act at this step."""
    found = _faulted(s)
    return any_of(*(a & ~b for a, b in zip(found.active, found.acted, strict=True)))


def _faulted(s: Seen) -> Faulted:
    return s._faulted or Faulted(s._system, (), (), (), ())


def _named(s: Seen, names: Sequence[str], which: Callable[[Faulted], Sequence[Bit]]) -> Bit:
    found = _faulted(s)
    known = [f.name for f in found.faults]
    for name in names:
        if name not in known:
            raise ModelError(f"no fault is called {name!r} here; {nearest(name, known)}")
    return any_of(*(b for name, b in zip(known, which(found), strict=True) if name in names))


# --- time: registers that watch ------------------------------------------------------------------------------------

_watch: ContextVar[dict[Any, State] | None] = ContextVar("watch", default=None)


def watching(registers: dict[Any, State], formula: Formula, seen: Seen) -> Bit:
    """Evaluate a formula; the registers that its time operators need are added to `registers`."""
    token = _watch.set(registers)
    try:
        result = formula(seen)
    finally:
        _watch.reset(token)
    if not isinstance(result, Bit):
        raise ModelError(f"{getattr(formula, '__name__', 'a formula')} returns {result!r}; a claim returns a Bit")
    return result


def _register(key: Any, make: Callable[[str], State]) -> Term:
    registers = _watch.get()
    if registers is None:
        raise ModelError("age, persists, once, since, previous, last and total are used inside claims and lemmas only")
    if key not in registers:
        registers[key] = make(f"watch.{key[0]}{len(registers)}")
    return registers[key].var


def _up_to(name: str, upto: int) -> None:
    if type(upto) is not int or upto < 1:
        raise ModelError(f"{name}(..., {upto!r}): a number of steps or units is a whole number from 1 up")


def age(condition: Bit, upto: int) -> UInt:
    """For how many steps just before this one the condition held without a break, counted up to `upto`."""
    _up_to("age", upto)
    width = upto.bit_length()

    def make(name: str) -> State:
        ticks = cast(UInt, variable(name, uint(width)))
        older = select(ticks < upto, (ticks + 1).low(width), ticks)
        return State(ticks, select(condition, older, 0), 0)

    return cast(UInt, _register(("age", condition.uid, upto), make))


def persists(condition: Bit, ticks: int) -> Bit:
    """Whether the condition has held at this step and the ones before, `ticks` steps in all."""
    _up_to("persists", ticks)
    return condition & (age(condition, ticks) >= ticks - 1)


def once(condition: Bit) -> Bit:
    """Whether the condition held at some step before this one."""

    def make(name: str) -> State:
        seen = cast(Bit, variable(name, BIT))
        return State(seen, seen | condition, False)

    return cast(Bit, _register(("once", condition.uid), make))


def since(event: Bit, condition: Bit) -> Bit:
    """Whether the event has happened before this step, and the condition has held at every step since (not at it)."""

    def make(name: str) -> State:
        held = cast(Bit, variable(name, BIT))
        return State(held, event | (held & condition), False)

    return cast(Bit, _register(("since", event.uid, condition.uid), make))


def previous(term: Any, initially: Any) -> Any:
    """The value of one step before; `initially` at the first, `ModelError` unless that is a value of its sort."""
    value = _before_the_first("previous", term, initially)
    return _register(
        ("previous", term.uid, type(value), value), lambda name: State(variable(name, term.sort), term, value)
    )


def last(term: Any, when: Bit, initially: Any) -> Any:
    """The value at the last step before this one at which the condition held; `initially` (see above) without one."""
    value = _before_the_first("last", term, initially)

    def make(name: str) -> State:
        kept: Any = variable(name, term.sort)
        return State(kept, select(when, term, kept), value)

    return _register(("last", term.uid, when.uid, type(value), value), make)


def _before_the_first(name: str, term: Any, value: Any) -> Any:
    if isinstance(value, Term) and value.is_const:
        value = value.attr
    if isinstance(value, Term) or not term.sort.admits(value):
        raise ModelError(f"{name}({describe(term)}, {value!r}): before the first step it is a value of {term.sort}")
    return value


def total(term: UInt, upto: int) -> UInt:
    """The sum of a word over all steps before this one, counted up to `upto`."""
    _up_to("total", upto)
    width = upto.bit_length()

    def make(name: str) -> State:
        sum_ = cast(UInt, variable(name, uint(width)))
        more = sum_ + term
        return State(sum_, select(more > upto, word(upto, width), more.low(width)), 0)

    return cast(UInt, _register(("total", term.uid, upto), make))


def premises_of(holds: Bit) -> list[Bit]:
    """What has to happen for a formula to say anything: the premise of each implication in a conjunction.

    Where the conclusion is an implication too, both premises have to happen at once.  `true` for any other formula.
    """
    if holds.op == "implies":
        premise, conclusion = (cast(Bit, a) for a in holds.args)
        return [premise if inner.is_const and inner.attr else premise & inner for inner in premises_of(conclusion)]
    if holds.op == "and":
        parts = [p for side in holds.args for p in premises_of(cast(Bit, side))]
        asking = [p for p in parts if not (p.is_const and p.attr)]
        return list({p.uid: p for p in asking}.values()) or [bit(True)]
    return [bit(True)]


def label(formula: Formula) -> str:
    """The name a formula is shown by."""
    return getattr(formula, "__name__", "formula").replace("_", " ")
