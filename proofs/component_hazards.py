"""The component table of ATS-SP and radio control, row by row: direction stated, found by injection, found by proof.

By proof means minimal cut sets that are complete at every order over the faults of a part, on all its runs; a row is a
single, or only in pairs, or in none.  Each hazard is that of a part: what follows for the train shows injection, on
stated rides.
Main results: the rows that injection finds wrong-side are singles by proof.  Three other singles are not wrong-side for
the train on the rides of injection: what makes the count run ahead of the train puts it behind s_lo.  Two dangerous
rows of the table are no singles by either: replay of messages is in no set, the comparator that says equal in a pair.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from models.ats.failures import Mode, row_of
from models.ats.failures import table as components
from proofs import (
    ats_hazards,
    ats_hazards_parts,
    dual_processor,
    dual_processor_hazards,
    position_group_hazards,
    position_hazards,
    radio_hazards,
)
from safety import Fault
from safety.exhibits import Column, Row, table

SINGLE, PAIR, NEVER, NO_PROOF = "single", "only in pairs", "in no set", "no cut sets"


class Hazard(NamedTuple):
    """What cut sets were looked for: the rows that could be in them, and those that are."""

    id: str
    rows: frozenset[str]
    singles: frozenset[str]
    pairs: frozenset[str] = frozenset()


def over(id: str, faults: Sequence[Fault], singles: Sequence[str]) -> Hazard:
    """A hazard whose faults have the names of the rows."""
    return Hazard(id, frozenset(row_of(f.name) for f in faults), frozenset(map(row_of, singles)))


PROCESSORS = {
    dual_processor.A.name: "processor: single fault", dual_processor.B.name: "processor: single fault",
    dual_processor.SAME_FAULT.name: "processor: common fault", dual_processor.EQUAL.name: "comparator: stuck equal",
    dual_processor.UNEQUAL.name: "comparator: stuck unequal", dual_processor.NO_CLOCK.name: "clock, supply: loss",
    dual_processor_hazards.NO_SUPPLY.name: "clock, supply: loss",
    dual_processor.WRONG_ENTRY.name: ats_hazards_parts.WRONG_ENTRY,
    dual_processor_hazards.WELDED.name: ats_hazards_parts.ENERGISED,
}  # fmt: skip
"""The faults of the dual processors by the rows of the table."""

HAZARDS = (
    over("ats_hazards.a_stop_is_forgotten", ats_hazards.FAULTS, ats_hazards.SINGLES),
    over("ats_hazards_parts.turnout_without_a_limit", ats_hazards_parts.BRANCHING, ats_hazards_parts.UNTOLD),
    over("ats_hazards_parts.released_without_the_phase", ats_hazards_parts.RECEIVER, ats_hazards_parts.FALSE_N),
    over("ats_hazards_parts.signal_is_passed", ats_hazards_parts.BRAKE, ats_hazards_parts.LATE),
    over("ats_hazards_parts.warned_too_late", ats_hazards_parts.LOOP, (ats_hazards_parts.WRONG,)),
    over("position_hazards.farther_or_faster_than_believed", position_hazards.FAULTS, position_hazards.UNDER),
    over("position_hazards.not_as_far_as_believed", position_hazards.FAULTS, position_hazards.OVER),
    Hazard(
        "position_group_hazards.a_group_is_misread",
        frozenset(f.name for f in position_group_hazards.FAULTS),
        frozenset({position_group_hazards.BOTH}),
        frozenset({position_group_hazards.MISSING, position_group_hazards.EXTRA}),
    ),
    over("radio_hazards.the_leader_is_run_into", radio_hazards.FAULTS, radio_hazards.SINGLES),
    Hazard(
        "dual_processor_hazards.energised_where_the_truth_forbids",
        frozenset(PROCESSORS.values()),
        frozenset(PROCESSORS[name] for name in dual_processor_hazards.SINGLES),
        frozenset(PROCESSORS[name] for pair in dual_processor_hazards.PAIRS for name in pair),
    ),
)

NOT_ASKED = {
    "line data ROM/IC card: bit error": "by induction instead: dual_processor.two_wrong_bits_are_rejected",
    "clock, supply: brown-out": "injection only",
    "display: wrong / dead": "by structure instead: nothing on the stretch reads it",
    radio_hazards.DELAY: "needs none: in every run of radio_hazards the air may delay any message",
}
"""Rows without cut sets, and why."""

BEHIND = "for the signal it brakes early; but the train may be behind s_lo, by which targets end"
NOT_ON_THE_RIDES = dict.fromkeys(position_hazards.OVER, BEHIND)
"""Singles by proof that are not wrong-side for the train on the rides of injection, and why."""


def by_proof(name: str) -> str:
    """What the cut sets say of a row."""
    if any(name in hazard.singles for hazard in HAZARDS):
        return SINGLE
    if any(name in hazard.pairs for hazard in HAZARDS):
        return PAIR
    return NEVER if any(name in hazard.rows for hazard in HAZARDS) else NO_PROOF


def asked(name: str) -> str:
    """The hazards of which a row is a single, else those it could have been in."""
    of = [h for h in HAZARDS if name in h.singles] or [h for h in HAZARDS if name in h.rows]
    return ", ".join(h.id for h in of)


def explained(mode: Mode) -> str:
    """Why the three do not agree, or why there is no proof."""
    reasons = (mode.why, NOT_ON_THE_RIDES.get(mode.name, ""), NOT_ASKED.get(mode.name, ""))
    return "; ".join(reason for reason in reasons if reason)


@table(
    id="component_hazards.rows",
    title="Component table of ATS-SP and radio: direction stated, by injection, by proof",
    source="[A] directions, sizes of the faults; [D] injection and cut sets",
    columns=(Column("row"), Column("table"), Column("injection"), Column("cut sets"), Column("of"), Column("why")),
    note="D dangerous, S restrictive, N neither; cut sets are complete at every order over the faults of their part",
    assumed=("[A] sizes of the faults",),
)
def rows() -> Iterator[Row]:
    """The 44 rows."""
    for mode in components():
        found = "D" if mode.wrong_side else "not D"
        yield mode.name, mode.direction, found, by_proof(mode.name), asked(mode.name), explained(mode)
