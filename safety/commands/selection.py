"""What a command works on: items of the project, chosen by words, requirement, or the last results."""

from __future__ import annotations

import re
from argparse import Namespace
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from safety.commands import CommandError
from safety.project import Project
from safety.report.standing import standing

_TOKEN = re.compile(r"\s*(\(|\)|[^\s()]+)")


@dataclass(frozen=True)
class Item:
    """What has a result: a claim, a synthesis, a campaign, a hazard (section "trees"), a rate, a figure, an exhibit."""

    section: str
    id: str
    model: str = ""
    requirement: str = ""
    statement: str = ""
    expect: str = ""

    @property
    def is_bound(self) -> bool:
        """Whether it is a claim of a bound over reals, which no model has."""
        return self.section == "claims" and not self.model

    @property
    def words(self) -> str:
        """What -k looks at."""
        return f"{self.id} {self.model} {self.requirement}".lower()


def items(project: Project, sections: Iterable[str]) -> list[Item]:
    """All items of some sections, in the order in which they are declared."""
    return [item for section in sections for item in _ITEMS[section](project)]


def _claims(project: Project) -> list[Item]:
    """Claims about models, then those over reals, which have no model."""
    about = [Item("claims", c.id, c.model.__name__, c.requirement, c.statement, c.expect) for c in project.claims]
    bounds = [Item("claims", b.id, "", b.about.requirement, b.statement, b.expect) for b in project.bounds]
    taken = {item.id for item in about} & {item.id for item in bounds}
    if taken:
        raise CommandError(
            f"a bound and a claim about a model are both called {min(taken)!r}; give the bound another id"
        )
    return [*about, *bounds]


def _syntheses(project: Project) -> list[Item]:
    return [
        Item("syntheses", s.id, s.model.__name__ if s.model else "", s.requirement, s.statement)
        for s in project.syntheses
    ]


def _campaigns(project: Project) -> list[Item]:
    from safety.inject.result import model_name

    return [Item("campaigns", c.id, model_name(c)) for c in project.campaigns]


def _hazards(project: Project) -> list[Item]:
    claims = [hazard.claim for hazard in project.hazards]
    return [Item("trees", c.id, c.model.__name__, c.requirement, c.statement) for c in claims]


def _rates(project: Project) -> list[Item]:
    return [Item("rates", rate.id, statement=rate.quantity) for rate in project.rates]


def _exhibits(project: Project) -> list[Item]:
    return [Item("exhibits", one.id, requirement=one.requirement, statement=one.title) for one in project.exhibits]


def _figures(project: Project) -> list[Item]:
    return [
        Item("figures", one.id, requirement=one.requirement, statement=f"{one.printed} {one.unit}".rstrip())
        for one in project.figures
    ]


_ITEMS = {
    "claims": _claims,
    "syntheses": _syntheses,
    "campaigns": _campaigns,
    "trees": _hazards,
    "rates": _rates,
    "figures": _figures,
    "exhibits": _exhibits,
}


def select(found: Sequence[Item], args: Namespace, last: Mapping[str, Any]) -> list[Item]:
    """The items that -k, --req and --lf leave.  Raises CommandError for an expression that cannot be read."""
    wanted = expression(args.keyword)
    chosen = [item for item in found if wanted(item.words) and (not args.req or item.requirement in args.req)]
    if args.lf:
        failed = [item for item in chosen if any(_off(item, last))]
        return failed or chosen
    return chosen


def _off(item: Item, last: Mapping[str, Any]) -> Iterable[bool]:
    return (standing(item.section, e).code != 0 for e in last.get(item.section, ()) if e["id"] == item.id)


def expression(text: str) -> Callable[[str], bool]:
    """A test of words, from an expression as in pytest: `voter and not (trip or late)`; empty: everything."""
    tokens = _TOKEN.findall(text.lower())

    def either() -> Callable[[str], bool]:
        parts = [both()]
        while tokens[:1] == ["or"]:
            tokens.pop(0)
            parts.append(both())
        return lambda words: any(part(words) for part in parts)

    def both() -> Callable[[str], bool]:
        parts = [one()]
        while tokens[:1] == ["and"]:
            tokens.pop(0)
            parts.append(one())
        return lambda words: all(part(words) for part in parts)

    def one() -> Callable[[str], bool]:
        token = tokens.pop(0) if tokens else ""
        if token == "not":
            inner = one()
            return lambda words: not inner(words)
        if token == "(":
            inner = either()
            if tokens[:1] != [")"]:
                raise CommandError(f"-k {text!r}: a bracket is not closed")
            tokens.pop(0)
            return inner
        if token in ("", "and", "or", ")"):
            raise CommandError(f"-k {text!r}: a word is missing" + (f" before {token!r}" if token else " at the end"))
        return lambda words: token in words

    if not tokens:
        return lambda words: True
    result = either()
    if tokens:
        raise CommandError(f"-k {text!r}: `and` or `or` is missing before {tokens[0]!r}")
    return result
