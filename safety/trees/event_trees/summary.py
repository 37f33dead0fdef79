"""What a results document says of event trees: the entries of "event_trees", one for each initiating event."""

from __future__ import annotations

import time
from collections.abc import Iterator
from fractions import Fraction
from itertools import groupby
from typing import TYPE_CHECKING, Any, NamedTuple

from safety.trees.event_trees.answers import EventTreeAnswer, Figure, SequenceAnswer, analyse, consequences
from safety.trees.importance.events import plain
from safety.trees.study import expressions_in
from safety.trees.summary import EXACT_BITS, LISTED, cut_set_rows

if TYPE_CHECKING:
    from safety.trees.study import Alignment, Phase, Study
    from safety.trees.uncertainty.sampling import Plan


class Answered(NamedTuple):
    """What follows one initiating event, in one phase of an alignment if there are any."""

    answer: EventTreeAnswer
    alignment: Alignment | None
    phase: Phase | None
    seconds: float

    @property
    def fraction(self) -> Fraction:
        """Of the time for which the answer holds."""
        return self.phase.fraction if self.phase else Fraction(1)


def answers_of(study: Study) -> list[Answered]:
    """Analyse every initiating event that starts an event tree, in each phase. Raises TreeError, TooLarge."""
    found = []
    for alignment in study.alignments or (None,):
        for phase in (alignment.phases if alignment else ()) or (None,):
            for initiating in (one for one in study.initiating_events if one.event_tree):
                started = time.perf_counter()
                answer = analyse(study, initiating, dict(phase.house) if phase else None)
                found.append(Answered(answer, alignment, phase, time.perf_counter() - started))
    return found


def event_tree_entries(
    study: Study, answers: list[Answered] | None = None, *, source: str = "", listed: int = LISTED
) -> list[dict[str, Any]]:
    """The entry of each of `answers` (see `answers_of`).

    With alignments there is one entry for each of their phases, and the frequency over all initiating events is the
    mean over the phases of an alignment. "probability" is that of a sequence given the initiating event, "frequency"
    the same times its frequency (in the unit of that, None where there is none). "partition" is whether the sequences
    share out all that can happen, None where that is not known, and "wrong" says what speaks against it.
    Figures lie between their "_low" and "_high" whatever the rounding; those of a sequence with "assumed" rest on an
    assumed event, split fraction or frequency, that over all initiating events with "assumed_over_all", and the
    frequency of an entry with "assumed". Raises TreeError, TooLarge.
    """
    entries = []
    for together in _by_alignment(answers_of(study) if answers is None else answers):
        everywhere = consequences((one.answer, one.fraction) for one in together)
        found = []
        for answer, alignment, phase, solve_s in together:
            started = time.perf_counter()
            entry = _entry(answer, study, source, listed)
            if alignment and phase:
                entry["id"] += f", {alignment.name}, {phase.name}"
                entry |= {"alignment": alignment.name, "phase": phase.name, "time_fraction": float(phase.fraction)}
            for sequence in entry["sequences"]:
                figure = everywhere[sequence["id"]]
                sequence["frequency_of_all_initiating_events"] = None if figure is None else figure.value
            entry["seconds"] = {"total": solve_s + time.perf_counter() - started}
            found.append(entry)
        assumed = {one["id"] for entry in found for one in entry["sequences"] if one["assumed"]}
        for sequence in (one for entry in found for one in entry["sequences"]):
            sequence["assumed_over_all"] = sequence["id"] in assumed
        entries += found
    return entries


def add_uncertainty(
    entries: list[dict[str, Any]], answers: list[Answered], plan: Plan, mission_time_h: Fraction | None
) -> None:
    """Add to the entries of `answers` how the figures of each sequence spread (see `uncertainty`). Raises TreeError."""
    from safety.trees.event_trees.uncertainty import propagate

    spreads = []
    for together in _by_alignment(answers):
        spreads += propagate([(one.answer, one.fraction) for one in together], plan, mission_time_h)
    for entry, spread in zip(entries, spreads, strict=True):
        for sequence in entry["sequences"]:
            sequence |= spread[sequence["id"]].fields()


def _by_alignment(answers: list[Answered]) -> Iterator[list[Answered]]:
    for _, together in groupby(answers, key=lambda one: id(one.alignment)):
        yield list(together)


def _entry(answer: EventTreeAnswer, study: Study, source: str, listed: int) -> dict[str, Any]:
    tree = next(one for one in study.event_trees if one.name == answer.initiating.event_tree)
    often, factors = (
        any(one.is_assumed for one in expressions_in(part)) for part in (answer.initiating, study.event_trees)
    )
    return {
        "id": answer.initiating.name,
        "description": answer.initiating.description,
        "source": source,
        "event_tree": tree.name,
        **_figure("frequency", answer.frequency),
        "assumed": often,
        "functional_events": [{"id": one.name, "description": one.description} for one in tree.functional_events],
        "sequences": [_sequence(answer, one, listed, often or factors) for one in answer.sequences.values()],
        **_figure("total", answer.total),
        "whole": None if answer.whole is None else answer.whole.value,
        "partition": answer.is_partition,
        "wrong": list(answer.wrong),
    }


def _sequence(answer: EventTreeAnswer, sequence: SequenceAnswer, listed: int, factors: bool) -> dict[str, Any]:
    sources = {event.name: event.source for event in sequence.solution.tree.events}
    importance = sorted(sequence.importance().values(), key=lambda one: (-abs(one.criticality or 0), one.event))
    return {
        "id": sequence.name,
        "description": sequence.solution.tree.description,
        **_figure("probability", sequence.probability),
        **_figure("frequency", answer.frequency_of(sequence.name)),
        "paths": [dict(course.states) for course in sequence.courses],
        "minimal_cut_sets": cut_set_rows(sequence.solution, listed),
        "importance": [plain(one) | {"source": sources[one.event]} for one in importance],
        "assumed": factors or "A" in sources.values(),
    }


def _figure(key: str, figure: Figure | None) -> dict[str, Any]:
    if figure is None:
        return {key: None, f"{key}_low": None, f"{key}_high": None, f"{key}_exact": None}
    exact = figure.exact
    written = None if exact is None or exact.denominator.bit_length() > EXACT_BITS else str(exact)
    return {
        key: figure.value,
        f"{key}_low": figure.within.low,
        f"{key}_high": figure.within.high,
        f"{key}_exact": written,
    }
