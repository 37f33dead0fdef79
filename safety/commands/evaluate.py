"""One item's entry in the results document: the work that a worker process does for it."""

from __future__ import annotations

import sys
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from safety.commands.recall import SCRIPTED, folder, recalled
from safety.commands.selection import Item
from safety.project import Problem, Project, Value
from safety.prove.cache import Cache

if TYPE_CHECKING:
    from safety.audit import Entry as Figure
    from safety.exhibits import Exhibit
    from safety.inject import Campaign
    from safety.model import Model
    from safety.prove.bounds.claims import RealClaim
    from safety.prove.claims import Claim
    from safety.prove.hazards import Hazard
    from safety.prove.outcome import Limits, Outcome
    from safety.prove.problem import Problem as Asked
    from safety.prove.weakest import Synthesis
    from safety.rates.claims import Rate

Entry = dict[str, Any]
Named = TypeVar("Named", "Claim", "RealClaim", "Campaign", "Hazard", "Rate", "Exhibit", "Figure", "Synthesis")
Note = Callable[[str], None]


@dataclass
class Order:
    """How to work, for all items alike."""

    timeout: float = 60.0
    settings: Mapping[str, Value] = field(default_factory=dict)
    vcd: bool = False
    certify: str = ""  # the folder for certificates
    traceback: bool = False
    cache: bool = False
    again: Sequence[str] = ()  # claims to prove and to compare with what the cache says
    injecting: Mapping[str, Any] = field(default_factory=dict)  # of campaigns, see `injecting.Wishes`


@dataclass
class Answer:
    """What came of an item: its entry, unless a problem in the project's files stands in the way."""

    item: Item
    entry: Entry | None = None
    problem: Problem | None = None
    vcd: str = ""
    reads: list[tuple[str, Any]] = field(default_factory=list)  # files read for it, each with its time and size


def evaluate(project: Project, item: Item, order: Order, note: Note, how: Evaluate | None = None) -> Answer:
    """Work out an item, as usual or by `how`; an error becomes a problem of the project's or an entry that says so.

    Raises `StoreError` when `how` has nowhere to put its results, or nobody to make them.
    """
    began = time.perf_counter()
    try:
        _written_for(project, item, order)
        return (how or _EVALUATE[item.section])(project, item, order, note)
    except Exception as error:
        if how is not None and _of_a_store(error):
            raise
        if project.is_users(error):
            return Answer(item, problem=_problem(project, item, error))
        if order.traceback:
            traceback.print_exc()
        entry = without_result(item, error)
        return Answer(item, entry | {"seconds": round(time.perf_counter() - began, 3)})


def _written_for(project: Project, item: Item, order: Order) -> None:
    """Refuse settings under which the item's numbers say nothing."""
    if order.settings and item.section in ("claims", "trees", "campaigns"):
        from safety.prove.written_for import check

        claims = {"claims": project.claims, "trees": [hazard.claim for hazard in project.hazards]}
        own = next((each.own_parameters for each in claims.get(item.section, ()) if each.id == item.id), {})
        check(item.id, models_of(project, item), own, order.settings)


def _of_a_store(error: Exception) -> bool:
    from safety.inject.store import StoreError

    return isinstance(error, StoreError)


def without_result(item: Item, error: Exception | str) -> Entry:
    """The entry of an item that came to nothing: engines that disagree, or an internal error."""
    broken = _of_a_solver(error)
    code = 3 if broken else getattr(error, "exit_code", 70)
    text = broken or (str(error) if code != 70 or isinstance(error, str) else f"{type(error).__name__}: {error}")
    base: Entry = {
        "id": item.id,
        "model": item.model,
        "requirement": item.requirement or None,
        "statement": item.statement,
    }
    match item.section:
        case "claims":
            base |= {"model": item.model or None, "expect": item.expect, "verdict": "undecided", "why": text}
            said: Entry = {"disagreed_by": ["the engines"]} if code == 6 else {}
        case "syntheses":
            base |= {"model": item.model or None, "parameter": "", "safe_from": None, "refuted_at": None}
            base |= {"settled": False, "why": text}
            said = {"disagreed_by": ["the engines"]} if code == 6 else {}
        case "campaigns":
            classes = dict.fromkeys(("safe", "detected", "dangerous_undetected", "no_effect"), 0)
            base |= {"injections": 0, "exhaustive": False, "classes": classes, "note": text}
            said = {"disagreed_by": [text]} if code == 6 else {}
        case "trees":
            base |= {"probability": None, "probability_low": 0.0, "probability_high": None, "note": text}
            said = {}
        case "figures":
            base |= {"printed": item.statement, "verdict": None, "note": text}
            said = {"disagreed_by": [text]} if code == 6 else {}
        case "exhibits":
            base |= {"title": item.statement, "as_expected": False, "note": text}
            said = {}
        case _:
            base |= {"quantity": item.statement, "value": None, "note": text}
            said = {"agree": False} if code == 6 else {}
    return base | (said if code in (3, 6) else {"error": text})


def _of_a_solver(error: Exception | str) -> str:
    """What to say of a solver that broke down, or of memory that ran out; nothing for any other error."""
    home = type(error).__module__.partition(".")[0]
    if not isinstance(error, MemoryError) and home not in ("z3", "cvc5"):
        return ""
    said = getattr(error, "value", None) or str(error) or type(error).__name__
    said = said.decode(errors="replace") if isinstance(said, bytes) else said
    return f"{home if home != 'builtins' else 'the prover'} broke down: {said}; give -j 1, or the claim a smaller bound"


def fitting(model: type[Model], settings: Mapping[str, Value]) -> dict[str, Value]:
    """The settings that name a parameter of the model."""
    return {name: value for name, value in settings.items() if has_parameter(model, name)}


def fitting_claim(claim: Claim, settings: Mapping[str, Value]) -> dict[str, Value]:
    """The settings that name a parameter of a claim's model, or of the one that it refines."""
    upper = fitting(claim.refinement.upper, settings) if claim.refinement is not None else {}
    return {**upper, **fitting(claim.model, settings)}


def models_of_claim(claim: Claim) -> list[type[Model]]:
    """The model of a claim, and the one that it refines."""
    return [claim.model, *([claim.refinement.upper] if claim.refinement is not None else [])]


def models_of(project: Project, item: Item) -> list[type[Model]]:
    """The models that an item is about."""
    if item.is_bound:
        return []
    match item.section:
        case "claims":
            return models_of_claim(find(project.claims, item.id))
        case "syntheses":
            about = find(project.syntheses, item.id).model
            return [about] if about else []
        case "trees":
            return [find(project.hazards, item.id).claim.model]
        case "campaigns":
            model = find(project.campaigns, item.id).model
            return [model] if isinstance(model, type) else []
    return []


def has_parameter(model: type[Model], name: str) -> bool:
    """Whether a setting's name (or pattern) fits a parameter of the model."""
    from safety.system import ModelError
    from safety.tracing import resolve

    try:
        resolve(model, {name: None})
    except ModelError:
        return False
    return True


def _claim(project: Project, item: Item, order: Order, note: Note) -> Answer:
    if item.is_bound:
        return _over_reals(project, item, order, note)
    from safety.prove.prove import Limits, stated
    from safety.prove.record import claim_entry
    from safety.prove.stimulus import stimulus

    claim = find(project.claims, item.id)
    problem = stated(claim, fitting_claim(claim, order.settings))
    cache = Cache(folder(project.root), _warn) if order.cache else None
    found = recalled(cache, problem, Limits(order.timeout), item.id in order.again, note)
    outcome = found.outcome
    entry, trace = claim_entry(outcome) | found.marks, outcome.counterexample
    if order.certify:
        from safety.commands.certify import certified

        entry["certificate"] = certified(outcome, Path(order.certify), order.timeout, note, _warn)
    if trace is None:
        return Answer(item, entry)
    given = None if outcome.method.startswith(SCRIPTED) else stimulus(trace)  # a script stands in the proof file
    entry["counterexample"] |= {"stimulus": given, "vcd": None}
    return Answer(item, entry, vcd=trace.vcd() if order.vcd else "")


def _over_reals(project: Project, item: Item, order: Order, note: Note) -> Answer:
    claim = find(project.bounds, item.id)
    entry = claim.evaluate(order.timeout)
    if order.certify:
        from safety.commands.certify import certified_over_reals

        entry["certificate"] = certified_over_reals(claim, entry, Path(order.certify), order.timeout, note, _warn)
    return Answer(item, entry)


def _synthesis(project: Project, item: Item, order: Order, note: Note) -> Answer:
    from safety.prove.outcome import Limits
    from safety.prove.weakest_search import find as weakest

    cache = Cache(folder(project.root), _warn) if order.cache else None

    def decided(problem: Asked, limits: Limits) -> Outcome:
        return recalled(cache, problem, limits).outcome

    synthesis = find(project.syntheses, item.id)
    settings = fitting(synthesis.model, order.settings) if synthesis.model else {}
    return Answer(item, weakest(synthesis, Limits(order.timeout), decided, note, settings).to_json())


def _campaign(project: Project, item: Item, order: Order, note: Note) -> Answer:
    from safety.commands.injecting import Wishes, injected, prepare

    campaign, wishes = find(project.campaigns, item.id), Wishes(**order.injecting)
    prepare(campaign, wishes, order.settings)
    return Answer(item, injected(campaign, wishes, project, note))


def _hazard(project: Project, item: Item, order: Order, note: Note) -> Answer:
    from safety.prove.hazards import cut_sets
    from safety.prove.prove import Limits
    from safety.trees.from_model import told, tree_entry

    hazard = find(project.hazards, item.id)
    claim = hazard.claim
    hazard = replace(hazard, claim=replace(claim, settings={**fitting(claim.model, order.settings), **claim.settings}))
    began = time.perf_counter()
    found = cut_sets(hazard, Limits(order.timeout), lambda sofar: note(told(sofar, hazard)))
    return Answer(item, tree_entry(found, hazard, time.perf_counter() - began))


def _rate(project: Project, item: Item, order: Order, note: Note) -> Answer:
    return Answer(item, find(project.rates, item.id).evaluate())


def _figure(project: Project, item: Item, order: Order, note: Note) -> Answer:
    figure, began = find(project.figures, item.id), time.perf_counter()
    entry = figure.evaluate()
    if figure.claim and figure.claim not in {
        *(each.id for each in project.claims),
        *(each.id for each in project.bounds),
    }:
        from safety.audit import AuditError

        raise AuditError(f"{item.id}: there is no claim {figure.claim!r}; `rightside list claims` names them")
    return Answer(item, entry | {"seconds": round(time.perf_counter() - began, 3)})


def _exhibit(project: Project, item: Item, order: Order, note: Note) -> Answer:
    began = time.perf_counter()
    entry = find(project.exhibits, item.id).evaluate()
    return Answer(item, entry | {"seconds": round(time.perf_counter() - began, 3)})


def _mutants(project: Project, item: Item, order: Order, note: Note) -> Answer:
    from safety.commands.mutants import examined

    return Answer(item, examined(project, item, order))


Evaluate = Callable[[Project, Item, Order, Note], Answer]
_EVALUATE: Mapping[str, Evaluate] = {
    "claims": _claim,
    "syntheses": _synthesis,
    "campaigns": _campaign,
    "trees": _hazard,
    "rates": _rate,
    "figures": _figure,
    "exhibits": _exhibit,
    "mutants": _mutants,
}


def find(declared: list[Named], wanted: str) -> Named:
    """The one of this id."""
    return next(one for one in declared if one.id == wanted)


def _warn(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def _problem(project: Project, item: Item, error: Exception) -> Problem:
    """At the line of the project's own code that failed, else where the claim or hazard is written."""
    place, line = None, 1
    if item.is_bound:
        bound = find(project.bounds, item.id)
        place, line = Path(bound.file), bound.line
    elif item.section == "claims":
        code = find(project.claims, item.id).formula.__code__
        place, line = Path(code.co_filename), code.co_firstlineno
    elif item.section in ("syntheses", "campaigns", "figures"):
        file, line = find(getattr(project, item.section), item.id).place
        place = Path(file)
    elif item.section == "exhibits":
        exhibit = find(project.exhibits, item.id)
        place, line = Path(exhibit.file), exhibit.line
    found = project.problem(error, place, line)
    named = found.message if item.id in found.message else f"{item.id}: {found.message}"
    return replace(found, message=named)
