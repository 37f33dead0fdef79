"""Where proof and simulation meet: each single fault of a campaign is proved harmless, or left to simulation.

A campaign names claims and hazards whose violation its wrong side is (`Campaign(proofs=[...])`).  Such a proof covers a
fault when its own fault can do at least as much: at the same points or more, byzantine or of the same effect, with an
onset that includes the campaign's.  What is proved holds for every input and for ever; what is simulated, for the
campaign's stimulus.  A fault that is proved harmless and found dangerous means that one of the two is wrong.

    compared(campaign, result, claims, hazards) -> each single fault: whether it is dangerous, and what covers it; and
                                                   for each claim the dangerous run that breaks it

`safety.report.closing` puts the verdicts of the claims to them.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, cast

from safety.faults import ANY_TIME, FROM_START, PREFIX, TRANSIENT, Fault, expand, instrument, matching, schedule
from safety.inject.space import CampaignError, Injection, Space, scheduled
from safety.kinds.kind import POINT, POINTS, Kind, Seat
from safety.prove.claims import Claim, claim_id
from safety.prove.problem import build_problem
from safety.system import System, nearest, substitute
from safety.terms import Bit
from safety.terms.graph import BIT, Sort, Term, variable
from safety.trace import run
from safety.tracing import trace

if TYPE_CHECKING:
    from safety.inject import Campaign, Result
    from safety.prove.hazards import Hazard

WRONG, HOLDS = "wrong/", "the claim holds"
TRIED = 8  # dangerous injections


def covers(wide: Fault, narrow: Fault, system: System) -> bool:
    """Whether whatever `narrow` can do in a run, `wide` can do in a proof; false where that is not plain to see."""
    if wide.kind.place != POINT or narrow.kind.place not in (POINT, POINTS):
        return False
    where, inside = (set(matching(system, fault.points)) for fault in (wide, narrow))
    sorts = [system.points[point].sort for point in where]
    if not inside <= where or any(sort.kind not in wide.kind.sorts for sort in sorts):
        return False
    if wide.onset != TRANSIENT and all(_is_free(wide.kind, sort) for sort in sorts):
        return True
    if narrow.kind.place != POINT or inside != where or not all(_alike(wide.kind, narrow.kind, s) for s in sorts):
        return False
    if wide.onset == ANY_TIME:
        return narrow.onset in (FROM_START, ANY_TIME)
    return wide.onset == narrow.onset and (wide.ticks or 0) >= (narrow.ticks or 0)


def _is_free(kind: Kind, sort: Sort) -> bool:
    """Whether a kind shows any value at every step, the healthy one too: it need not say when it begins or ends."""
    seat, seen = _probe(kind, sort)
    return not seat.states and [term.uid for term in seat.inputs.values()] == [seen.uid]


def _alike(kind: Kind, other: Kind, sort: Sort) -> bool:
    """Whether two kinds have one effect: the same terms, registers and choices."""
    if sort.kind not in other.sorts:
        return False
    probes = [_probe(each, sort) for each in (kind, other)]  # kept: equal terms are one only as long as they live
    told = [
        (seen.uid, [(s.var.uid, s.next.uid, s.power_up) for s in seat.states], sorted(seat.inputs))
        for seat, seen in probes
    ]
    return told[0] == told[1]


def _probe(kind: Kind, sort: Sort) -> tuple[Seat, Term]:
    seat = Seat("probe", cast(Bit, variable("probe active", BIT)))
    return seat, kind.effect(seat, variable("healthy value", sort))


def covering(claim: Claim, campaign: Campaign) -> dict[int, str]:
    """Which single faults of the campaign a claim covers: their places, each with the name of the claim's fault.

    Raises `CampaignError` for a claim that can say nothing about them: of another model, with other settings, under
    assumptions, or without faults.
    """
    system, space = campaign.system, campaign.space
    if claim.model is not campaign.model:
        raise _useless(campaign, claim, f"it is about {claim.model.__name__}")
    if claim.given is not None or claim.start is not None or claim.anywhere or claim.steps_per_frame != 1:
        raise _useless(campaign, claim, "it holds under assumptions, or in other steps")
    if claim.faults is None or claim.faults.most == 0:
        raise _useless(campaign, claim, "it allows no fault")
    proved = trace(claim.model, claim.settings, claim.symbolic).settings
    for scenario in range(campaign.scenarios):
        for path, used in campaign.variant(scenario).system.settings.items():
            if proved[path].value not in (None, used.value):  # None: left open in its range
                raise _useless(campaign, claim, f"{path} is {used.value} here and {proved[path].value} in the claim")
    allowed = expand(system, claim.faults.faults)
    found: dict[int, str] = {}
    for place, fault in enumerate(space.singles):
        narrow = fault if space.onsets is None else scheduled(fault, space.onsets[0], space.length)
        by = next((wide.name for wide in allowed if covers(wide, narrow, system)), None)
        if by is not None:
            found[place] = by
    return found


def _useless(campaign: Campaign, claim: Claim, why: str) -> CampaignError:
    return CampaignError(f"{campaign.id}: claim {claim.id} closes nothing here: {why}; leave it out of proofs=")


def compared(campaign: Campaign, result: Result, claims: Iterable[Claim], hazards: Iterable[Hazard]) -> dict[str, Any]:
    """`faults`: a row for each, with `id`, `rate_per_h`, whether it was found `dangerous`, and `by`, what covers it.

    `tied`: for each claim the injection that shows that it speaks of this campaign's danger, or None (see `tied`).
    """
    named = _named(campaign.proofs, claims, hazards, campaign.id)
    covered = {id_: covering(claim, campaign) for id_, claim in named.items()}
    space = campaign.space
    if space.order != 1:
        raise CampaignError(f"{campaign.id}: proofs= closes single faults; this campaign injects {space.order} at once")
    dangerous = {i.places[0] for i, cell in result.injections() if cell.startswith(WRONG)}
    rows = [
        {
            "id": fault.name,
            "rate_per_h": _rate(space, place),
            "dangerous": place in dangerous,
            "by": {id_: found[place] for id_, found in covered.items() if place in found},
        }
        for place, fault in enumerate(space.singles)
    ]
    return {"faults": rows, "tied": {id_: tied(campaign, result, claim) for id_, claim in named.items()}}


def tied(campaign: Campaign, result: Result, claim: Claim) -> str | None:
    """The first dangerous injection whose run breaks the claim: both speak of the same danger.

    None when none of the first `TRIED` does.  (A fault that is proved harmless cannot break it, whatever it does.)
    """
    dangerous = (injection for injection, cell in result.injections() if cell.startswith(WRONG))
    return next((one.id for one in itertools.islice(dangerous, TRIED) if _breaks(campaign, one, claim)), None)


def _breaks(campaign: Campaign, found: Injection, claim: Claim) -> bool:
    """Whether the run of an injection breaks a claim, whose own faults are absent in it."""
    variant = campaign.variant(found.scenario)
    used = {name: setting.value for name, setting in variant.system.settings.items()}
    settings = {name: value for name, value in used.items() if name not in claim.symbolic}
    bare = trace(claim.model, {**claim.settings, **settings}, claim.symbolic)
    broken = instrument(bare, found.faults)
    new = {name: name.replace(PREFIX, "injected", 1) for name in {*broken.system.state, *broken.system.inputs}}
    new = {name: other if name not in {*bare.state, *bare.inputs} else name for name, other in new.items()}
    problem = build_problem(claim, settings, lambda _: _renamed(broken.system, new))
    system = replace(problem.system, signals={**problem.system.signals, HOLDS: problem.holds}, assumptions={})
    choose, absent = schedule(broken), schedule(problem.faulted)  # what absent faults choose does nothing
    start = {**variant.start, **{name: used[name] for name in claim.symbolic if name in system.state}}
    drawn = {n: value for n, value in variant.values.items() if n in system.inputs and not callable(value)}

    def inputs(step: int) -> dict[str, Any]:
        chosen = {new[name]: value for name, value in choose(step).items()}
        return {
            **campaign.constant,
            **drawn,
            **variant.inputs(step // campaign.steps_per_frame),
            **chosen,
            **absent(step),
        }

    steps = campaign.timing.frames * campaign.timing.steps
    return not all(run(system, inputs, steps, start=start, keep=[HOLDS])[HOLDS])


def _renamed(system: System, new: Mapping[str, str]) -> System:
    """The system with other names for some registers and inputs."""
    leaves = [*(s.var for s in system.states), *system.inputs.values()]
    other = {v.uid: variable(new[str(v.attr)], v.sort) for v in leaves}
    whole = system.mapped(lambda terms: substitute(terms, other))
    states = tuple(replace(s, var=other[s.var.uid]) for s in whole.states)
    inputs = {new[name]: other[v.uid] for name, v in system.inputs.items()}
    return replace(whole, states=states, inputs=inputs, start=cast(Bit, substitute([system.start], other)[0]))


def _named(
    wanted: Sequence[Callable[..., Any]], claims: Iterable[Claim], hazards: Iterable[Hazard], place: str
) -> dict[str, Claim]:
    known = {claim.id: claim for claim in claims} | {hazard.id: hazard.claim for hazard in hazards}
    found: dict[str, Claim] = {}
    for formula in wanted:
        id_ = claim_id(formula)
        if id_ not in known:
            raise CampaignError(f"{place}: proofs= names {id_}, which is no claim and no hazard; {nearest(id_, known)}")
        found[id_] = known[id_]
    return found


def _rate(space: Space, place: int) -> str | None:
    group = space.of_group[place]
    whole = space.groups[group].rate_per_h
    return None if whole is None else str(Fraction(whole) / space.of_group.count(group))
