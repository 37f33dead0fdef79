"""`refines(Lower, Upper, steps)`: a detailed model does in `steps` of its steps what an abstract one does in one.

The claim is a function that reads the upper model's registers out of the lower one's.  Both are put side by side, the
lower one's steps taken as one; that what is read equals what the upper model holds, and that the named outputs are
equal, is then a claim like any other: proved by induction, or refuted with a replayed run.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

from safety.faults import Budget, within
from safety.fields import fit
from safety.model import Model
from safety.prove.claims import BITS, Claim, F, Formula, Scenario, Seen, claim_id, register
from safety.prove.problem import Change, Problem, as_written, equipped
from safety.system import ANY, ModelError, State, System, nearest, substitute
from safety.terms import Bit
from safety.terms.graph import Term, variable, variables
from safety.terms.values import all_of, bit
from safety.tracing import fitting, trace

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
    scenario: Scenario | None = None,
) -> Callable[[F], F]:
    """Declare that `lower` refines `upper`; the decorated function reads the upper registers from the lower ones.

    `at` says when the lower model stands at a frame boundary; `outputs` are compared after each frame (upper name to
    lower name, or one name for both).  Inputs have one name in both and are held during the frame.
    `faults` are those of the lower model, the upper one is healthy.  `scenario` is a scripted run in which they part.
    """

    def declare(read: F) -> F:
        statement = " ".join((read.__doc__ or "").split())
        if not statement:
            raise ModelError(f"refinement {read.__name__} says nothing: give it a docstring in plain words")
        pairs = outputs if isinstance(outputs, Mapping) else {o: o for o in outputs}
        twin, role = (claim_id(twin_of), "twin") if twin_of else (None, "refinement")
        register(
            Claim(
                claim_id(read), lower, read, statement, expect, requirement, source, faults, None, None, (), (), {},
                search, 1, BITS, scenario, None, twin, role, False, Refinement(upper, steps, read, at, pairs),
            )
        )  # fmt: skip
        return read

    return declare


def build_refinement(claim: Claim, settings: Mapping[str, Any] | None = None, change: Change = as_written) -> Problem:
    """The two models side by side, one upper step a step, as a problem like any other.

    `settings` go to each of the two that has such a parameter, `change` is for mutants of the lower model.  What the
    upper model assumes of inputs is assumed; what it assumes of its registers has to be shown.  Raises `ModelError` for
    registers, outputs or inputs that do not fit.
    """
    wanted: Refinement = claim.refinement
    given_to = {model: fitting(model, {**(settings or {}), **claim.settings}) for model in (claim.model, wanted.upper)}
    faulted = equipped(claim, change(trace(claim.model, given_to[claim.model])), wanted.steps)
    frame = faulted.system
    upper = _renamed(trace(wanted.upper, given_to[wanted.upper]), frame)
    read = _read(claim, Seen(frame, faulted), upper)
    same = {name: cast(Bit, read[name] == s.var) for name, s in _registers(upper).items()}
    aligned = wanted.at(Seen(frame, faulted)) if wanted.at else bit(True)
    outputs = _outputs(wanted, upper, frame)
    same_outputs = all_of(*(cast(Bit, frame.lookup(low) == upper.signals[up]) for up, low in outputs.items()))
    free = {v.uid for v in frame.inputs.values()}
    assumed = {f"{wanted.upper.__name__}: {text}": cast(Bit, a) for text, a in upper.assumptions.items()}
    of_inputs = {text: a for text, a in assumed.items() if all(v.uid in free for v in variables([a]))}
    met = all_of(*(a for text, a in assumed.items() if text not in of_inputs))
    system = replace(
        frame,
        name=f"{frame.name} beside {wanted.upper.__name__}",
        states=(*frame.states, *upper.states),
        signals={**frame.signals, **{f"spec.{name}": term for name, term in upper.signals.items()}},
        settings={**frame.settings, **{f"spec.{name}": setting for name, setting in upper.settings.items()}},
        assumptions={**frame.assumptions, **of_inputs},
    )
    budget = within(claim.faults, faulted) if claim.faults else bit(True)
    chosen = (same[name] for name, s in _registers(upper).items() if s.power_up is ANY)
    given = all_of(budget, *(cast(Bit, a) for a in system.assumptions.values()))
    lemmas = {f"{name} as read is {name} as held": equal for name, equal in same.items()}
    if wanted.at:
        lemmas["a frame ends where one begins"] = aligned
    holds = all_of(*same.values(), aligned, same_outputs, met)
    start = all_of(frame.start, budget, *chosen)
    return Problem(claim, system, replace(faulted, system=system), holds, (bit(True),), given, start, lemmas)


def _registers(upper: System) -> dict[str, State]:
    """The upper model's registers by the names that they have in it."""
    return {s.path.removeprefix("spec."): s for s in upper.states}


def _read(claim: Claim, seen: Seen, upper: System) -> dict[str, Term]:
    """What the claim reads for each upper register; a value that the register cannot hold is refused."""
    read = claim.refinement.read(seen)
    registers = _registers(upper)
    for name in sorted(registers.keys() ^ read.keys()):
        raise ModelError(
            f"{claim.id}: reads {sorted(read)}, the registers of {upper.name} are {sorted(registers)}; {name!r} differs"
        )
    return {name: fit(read[name], s.var.sort, f"{claim.id}: {name} as read") for name, s in registers.items()}


def _outputs(wanted: Refinement, upper: System, frame: System) -> Mapping[str, str]:
    for up, low in wanted.outputs.items():
        if up not in upper.signals:
            raise ModelError(f"{upper.name} has no output {up!r}; {nearest(up, upper.signals)}")
        if low not in frame.signals:
            raise ModelError(f"{frame.name} has no output {low!r}; {nearest(low, frame.signals)}")
    return wanted.outputs


def _renamed(upper: System, lower: System) -> System:
    """The upper system with its registers under `spec.` and the lower system's inputs."""
    mapping: dict[int, Term] = {s.var.uid: variable(f"spec.{s.path}", s.var.sort) for s in upper.states}
    for name, var in upper.inputs.items():
        if name not in lower.inputs or lower.inputs[name].sort != var.sort:
            raise ModelError(
                f"{upper.name} has the input {name}: {var.sort}; give {lower.name} one of that name and type"
            )
        mapping[var.uid] = lower.inputs[name]
    changed = upper.mapped(lambda terms: substitute(terms, mapping))
    states = tuple(State(mapping[s.var.uid], s.next, s.power_up) for s in changed.states)
    return replace(changed, states=states)
