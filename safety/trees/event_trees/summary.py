"""What a results document says of event trees: the entries of "event_trees", one for each initiating event."""

from __future__ import annotations

import time
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from safety.trees.event_trees.answers import EventTreeAnswer, Figure, SequenceAnswer, analyse, consequences
from safety.trees.importance.events import plain
from safety.trees.study import expressions_in
from safety.trees.summary import EXACT_BITS, LISTED, cut_set_rows

if TYPE_CHECKING:
    from safety.trees.study import Phase, Study


def event_tree_entries(study: Study, *, source: str = "", listed: int = LISTED) -> list[dict[str, Any]]:
    """Analyse every initiating event of `study` that starts an event tree, and give its entry.

    With alignments there is one entry for each of their phases, and the frequency over all initiating events is the
    mean over the phases of an alignment. "probability" is that of a sequence given the initiating event, "frequency"
    the same times its frequency (in the unit of that, None where there is none). "partition" is whether the sequences
    share out all that can happen, None where that is not known, and "wrong" says what speaks against it.
    Figures lie between their "_low" and "_high" whatever the rounding; those of a sequence with "assumed" rest on an
    assumed event, split fraction or frequency. Raises TreeError, TooLarge.
    """
    if not study.alignments:
        return _entries(study, source, listed, ("", ()))
    return [
        entry
        for alignment in study.alignments
        for entry in _entries(study, source, listed, (alignment.name, alignment.phases))
    ]


def _entries(study: Study, source: str, listed: int, alignment: tuple[str, tuple[Phase, ...]]) -> list[dict[str, Any]]:
    name, phases = alignment
    entries, answers = [], []
    for phase in phases or (None,):
        for initiating in study.initiating_events:
            if initiating.event_tree:
                started = time.perf_counter()
                answer = analyse(study, initiating, dict(phase.house) if phase else None)
                entry = _entry(answer, study, source, listed)
                if phase:
                    entry["id"] += f", {name}, {phase.name}"
                    entry |= {"alignment": name, "phase": phase.name, "time_fraction": float(phase.fraction)}
                entry["seconds"] = {"total": time.perf_counter() - started}
                entries.append(entry)
                answers.append((answer, phase.fraction if phase else Fraction(1)))
    everywhere = consequences(answers)
    for entry in entries:
        for sequence in entry["sequences"]:
            figure = everywhere[sequence["id"]]
            sequence["frequency_of_all_initiating_events"] = None if figure is None else figure.value
    return entries


def _entry(answer: EventTreeAnswer, study: Study, source: str, listed: int) -> dict[str, Any]:
    tree = next(one for one in study.event_trees if one.name == answer.initiating.event_tree)
    factors = any(one.is_assumed for one in expressions_in((answer.initiating, *study.event_trees)))
    return {
        "id": answer.initiating.name,
        "description": answer.initiating.description,
        "source": source,
        "event_tree": tree.name,
        **_figure("frequency", answer.frequency),
        "functional_events": [{"id": one.name, "description": one.description} for one in tree.functional_events],
        "sequences": [_sequence(answer, one, listed, factors) for one in answer.sequences.values()],
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
