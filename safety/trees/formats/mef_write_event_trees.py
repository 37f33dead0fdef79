"""Writing the event trees of Open-PSA MEF; `mef_event_trees` reads them back."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from safety.trees.event_trees import definitions as et
from safety.trees.formats import mef_xml as xml
from safety.trees.formats.mef_xml import Lines
from safety.trees.study import Study

Formula = Callable[[str], Lines]  # the formula that stands for a gate or event


def collected(study: Study) -> frozenset[str]:
    """The gates and events that the paths of event trees collect."""
    return frozenset(one.name for one in _instructions(study) if isinstance(one, et.CollectFormula))


def event_trees_to_mef(study: Study, formula: Formula) -> Lines:
    """The event trees, initiating events and rules of a study."""
    lines: Lines = []
    rules = {one.name: one for one in _instructions(study) if isinstance(one, et.Rule)}
    for start in study.initiating_events:
        head = {"name": start.name} | ({"event-tree": start.event_tree} if start.event_tree else {})
        frequency = [] if start.frequency is None else [et.CollectExpression(start.frequency)]
        inner = _written((*frequency, *start.instructions), formula)
        lines += xml.element("define-initiating-event", head, xml.label(start.description) + inner)
    for rule in rules.values():
        inner = xml.label(rule.description) + _written(rule.instructions, formula)
        lines += xml.element("define-rule", {"name": rule.name}, inner)
    for tree in study.event_trees:
        inner = xml.label(tree.description)
        for function in tree.functional_events:
            inner += xml.element("define-functional-event", {"name": function.name}, xml.label(function.description))
        for sequence in tree.sequences:
            parts = xml.label(sequence.description) + _written(sequence.instructions, formula)
            inner += xml.element("define-sequence", {"name": sequence.name}, parts)
        for named in tree.branches:
            parts = xml.label(named.description) + _branch(named.branch, formula)
            inner += xml.element("define-branch", {"name": named.name}, parts)
        inner += xml.element("initial-state", {}, _branch(tree.initial, formula))
        lines += xml.element("define-event-tree", {"name": tree.name}, inner)
    return lines


def _branch(branch: et.Branch, formula: Formula) -> Lines:
    lines = _written(branch.instructions, formula)
    target = branch.target
    if isinstance(target, et.ToSequence):
        return lines + xml.element("sequence", {"name": target.name})
    if isinstance(target, et.ToBranch):
        return lines + xml.element("branch", {"name": target.name})
    paths = [line for path in target.paths for line in _path(path, formula)]
    return lines + xml.element("fork", {"functional-event": target.functional_event}, paths)


def _path(path: et.Path, formula: Formula) -> Lines:
    return xml.element("path", {"state": path.state}, _branch(path.branch, formula))


def _written(instructions: Iterable[et.Instruction], formula: Formula) -> Lines:
    return [line for one in instructions for line in _instruction(one, formula)]


def _instruction(one: et.Instruction, formula: Formula) -> Lines:
    match one:
        case et.CollectFormula():
            return xml.element("collect-formula", {}, formula(one.name))
        case et.CollectExpression():
            return xml.element("collect-expression", {}, xml.value(one.expression))
        case et.SetHouseEvent():
            return xml.element("set-house-event", {"name": one.name}, xml.constant(one.state))
        case et.Choice():
            branches = [one.then] if one.otherwise is None else [one.then, one.otherwise]
            return xml.element("if", {}, _condition(one.test) + _written(branches, formula))
        case et.Block():
            return xml.element("block", {}, _written(one.instructions, formula))
        case et.Rule():
            return xml.element("rule", {"name": one.name})
        case et.Link():
            return xml.element("event-tree", {"name": one.event_tree})


def _condition(test: et.Condition) -> Lines:
    match test:
        case et.InitiatingEventIs():
            return xml.element("test-initiating-event", {"name": test.name})
        case et.FunctionalEventIs():
            return xml.element("test-functional-event", {"name": test.name, "state": test.state})
        case et.Combined():
            return xml.element(test.kind, {}, [line for part in test.parts for line in _condition(part)])


def _instructions(study: Study) -> Iterator[et.Instruction]:
    """Every instruction of a study, those inside of others after these."""
    for start in study.initiating_events:
        yield from _inside(start.instructions)
    for tree in study.event_trees:
        for sequence in tree.sequences:
            yield from _inside(sequence.instructions)
        for branch in (*(named.branch for named in tree.branches), tree.initial):
            yield from _along(branch)


def _along(branch: et.Branch) -> Iterator[et.Instruction]:
    yield from _inside(branch.instructions)
    if isinstance(branch.target, et.Fork):
        for path in branch.target.paths:
            yield from _along(path.branch)


def _inside(instructions: Iterable[et.Instruction]) -> Iterator[et.Instruction]:
    for one in instructions:
        yield one
        if isinstance(one, et.Block | et.Rule):
            yield from _inside(one.instructions)
        elif isinstance(one, et.Choice):
            yield from _inside([one.then] if one.otherwise is None else [one.then, one.otherwise])
