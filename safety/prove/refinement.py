"""`refines(Lower, Upper, steps)`: a detailed model does in `steps` of its steps what an abstract one does in one.

The claim is a function that reads the upper model's registers out of the lower one's.  Both are put side by side, the
lower one's steps taken as one; that what is read equals what the upper model holds, and that the named outputs are
equal, is then a claim like any other: proved by induction, or refuted with a replayed run.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

from safety.faults import Budget, instrument, within
from safety.model import Model
from safety.prove.claims import BITS, Claim, F, Formula, Seen, claim_id, register
from safety.prove.problem import Problem
from safety.system import ANY, ModelError, State, System, nearest, repeat, substitute
from safety.terms import Bit
from safety.terms.graph import Term, variable
from safety.terms.values import all_of, bit
from safety.tracing import trace

Reading = Callable[[Seen], Mapping[str, Any]]


@dataclass(frozen=True)
class Refinement:
    """What `refines` declares: the upper model, lower steps a step, when they are aligned, and the outputs compared."""

    upper: type[Model]
    steps: int
    read: Reading
    at: Formula | None
    outputs: Mapping[str, str]


def refines(
    lower: type[Model],
    upper: type[Model],
    *,
    steps: int,
    expect: str,
    outputs: Sequence[str] | Mapping[str, str] = (),
    at: Formula | None = None,
    requirement: str = "",
    source: str = "",
    search: int = 8,
    twin_of: Callable[..., Any] | None = None,
    faults: Budget | None = None,
) -> Callable[[F], F]:
    """Declare that `lower` refines `upper`; the decorated function reads the upper registers from the lower ones.

    `at` says when the lower model stands at a frame boundary; `outputs` are compared after each frame (upper name to
    lower name, or one name for both).  Inputs have one name in both and are held during the frame.
    `faults` are those of the lower model; the upper one is healthy.
    """

    def declare(read: F) -> F:
        statement = " ".join((read.__doc__ or "").split())
        if not statement:
            raise ModelError(f"refinement {read.__name__} says nothing: give it a docstring in plain words")
        pairs = outputs if isinstance(outputs, Mapping) else {o: o for o in outputs}
        register(
            Claim(
                claim_id(read), lower, read, statement, expect, requirement, source, faults, None, None, (), (), {}, search, 1,
                BITS, None, None, claim_id(twin_of) if twin_of else None, "twin" if twin_of else "refinement", False,
                Refinement(upper, steps, read, at, pairs),
            )
        )  # fmt: skip
        return read

    return declare


def build_refinement(claim: Claim) -> Problem:
    """The two models side by side, one upper step a step, as a problem like any other."""
    wanted: Refinement = claim.refinement
    lower = trace(claim.model)
    faulted = instrument(lower, claim.faults.expand(lower) if claim.faults else [], present=None)
    frame = repeat(faulted.system, wanted.steps)
    upper = _renamed(trace(wanted.upper), frame)
    read = wanted.read(Seen(frame))
    registers = {s.path.removeprefix("spec."): s for s in upper.states}
    for name in [*(registers.keys() - read.keys()), *(read.keys() - registers.keys())]:
        raise ModelError(f"{claim.id}: reads {sorted(read)}, the registers of {wanted.upper.__name__} are {sorted(registers)}; {name!r} differs")
    equal = all_of(*(cast(Bit, read[name] == s.var) for name, s in registers.items()))
    aligned = wanted.at(Seen(frame)) if wanted.at else bit(True)
    same_outputs = all_of(*(cast(Bit, frame.lookup(low) == upper.signals[up]) for up, low in _outputs(wanted, upper, frame).items()))
    system = replace(
        frame,
        name=f"{frame.name} beside {wanted.upper.__name__}",
        states=(*frame.states, *upper.states),
        signals={**frame.signals, **{f"spec.{k}": v for k, v in upper.signals.items()}},
        assumptions={**frame.assumptions, **upper.assumptions},
    )
    budget = within(claim.faults, faulted) if claim.faults else bit(True)
    start = all_of(frame.start, budget, *(cast(Bit, read[n] == s.var) for n, s in registers.items() if s.power_up is ANY))
    given = all_of(budget, *(cast(Bit, a) for a in system.assumptions.values()))
    lemmas = {f"{name} as read is {name} as held": cast(Bit, read[name] == s.var) for name, s in registers.items()}
    if wanted.at:
        lemmas["a frame ends where one begins"] = aligned
    return Problem(claim, system, replace(faulted, system=system), equal & aligned & same_outputs, bit(True), given, start, lemmas)


def _outputs(wanted: Refinement, upper: System, frame: System) -> Mapping[str, str]:
    for up, low in wanted.outputs.items():
        if up not in upper.signals:
            raise ModelError(f"{upper.name} has no output {up!r}; {nearest(up, upper.signals)}")
        frame.lookup(low)
    return wanted.outputs


def _renamed(upper: System, lower: System) -> System:
    """The upper system with its registers under `spec.` and the lower system's inputs."""
    mapping: dict[int, Term] = {s.var.uid: variable(f"spec.{s.path}", s.var.sort) for s in upper.states}
    for name, var in upper.inputs.items():
        if name not in lower.inputs or lower.inputs[name].sort != var.sort:
            raise ModelError(f"{upper.name} reads the input {name}: {var.sort}, which {lower.name} does not have; give it one of that name and type")
        mapping[var.uid] = lower.inputs[name]
    changed = upper.mapped(lambda terms: substitute(terms, mapping))
    states = tuple(State(mapping[s.var.uid], s.next, s.power_up) for s in changed.states)
    return replace(changed, states=states)
