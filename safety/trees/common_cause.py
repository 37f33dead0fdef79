"""Common cause failure: groups of basic events that may fail together, and the tree in which they do.

A group has n members, each of probability Q, all causes together. Q_k is the probability that one particular k of them
fail together by one cause, and no other member by that cause:

    beta-factor   Q_1 = (1 - beta) Q  and  Q_n = beta Q
    MGL           Q_k = rho_2 ... rho_k (1 - rho_(k+1)) Q / C(n-1, k-1), where rho_(n+1) = 0
    alpha-factor  Q_k = k alpha_k Q / (C(n-1, k-1) * sum of l alpha_l)    non-staggered testing
                  Q_k = alpha_k Q / (C(n-1, k-1) * sum of alpha_l)        staggered testing
    phi-factor    Q_k = phi_k Q

`apply` puts an event of probability Q_k in place of every such k, and makes each member the OR of those it is in. By
the first three models the Q_k of a member add up to Q; the member itself, an OR of independent events, then has
slightly less, in terms of second order. The factors of the fourth are taken as they are: with the sum of 1 that the
Exchange Format asks for, the Q_k of a member add up to more than Q if any level between 1 and n is used.

Members with a constant failure rate may have that shared out instead (`of_rates`): every such k then fails together
at the rate that the formulas give with the rate in the place of Q, and by the first three models a member fails at its
own rate exactly. This is the model of common shocks, in which all times to failure are exponential; the two differ in
terms of second order.

Sources: Open-PSA Model Exchange Format 2.0d (models, names, non-staggered testing, all probabilities scaled at the
time asked for); A. Mosleh et al., NUREG/CR-4780 (1988) and NUREG/CR-5485 (1998) (factors, kinds of testing); A. W.
Marshall, I. Olkin, J. Am. Statist. Assoc. 62 (1967) (shocks).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import reduce
from itertools import combinations
from operator import add
from typing import TYPE_CHECKING, Any, TypeGuard, cast

from safety.trees.as_written import Rational, TreeError, exact
from safety.trees.tree import DISAGREEMENT, BasicEvent, FaultTree, Gate

if TYPE_CHECKING:
    from safety.trees.expressions.expression import Expression

FIRST_LEVEL = {"beta-factor": None, "MGL": 2, "alpha-factor": 1, "phi-factor": 1}  # None: only that of all members
TESTING = ("non-staggered", "staggered")
MOST_EVENTS = 20_000  # that one group may become


@dataclass(frozen=True)
class CcfGroup:
    """Basic events that share causes.

    `factors` holds the model's factors by level, the number of members that fail together: beta at level n; the rho of
    MGL (beta, gamma, delta, ...) from level 2 on; alphas and phis from level 1 on. Levels left out at the end are 0.
    `total` is Q, a probability or an expression; None takes the members' own, which must then agree. `testing` matters
    to alpha factors only.

    Raises TreeError: unknown model or testing, fewer than two members or one given twice, levels that the model does
    not have, a factor outside 0..1, alphas or phis whose sum is more than 1 % from 1.
    """

    name: str
    model: str  # a key of FIRST_LEVEL
    members: tuple[str, ...]
    factors: Mapping[int, Rational | Expression]
    total: Rational | Expression | None = None
    testing: str = TESTING[0]
    description: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "members", tuple(self.members))
        self._check_words()
        levels = sorted(self.factors)
        first = FIRST_LEVEL[self.model] or self.size
        if not levels or levels != list(range(first, first + len(levels))) or levels[-1] > self.size:
            expected = (
                f"level {first}" if first == self.size else f"every level from {first} on, at most to {self.size}"
            )
            raise self._error(f"has factors at the levels {levels}, expected {expected}; correct the levels")
        checked = {level: self._number(self.factors[level], f"the factor at level {level}") for level in levels}
        object.__setattr__(self, "factors", checked)
        if self.total is not None:
            object.__setattr__(self, "total", self._number(self.total, "the distribution"))
        if self.model in ("alpha-factor", "phi-factor"):
            whole = math.fsum(f.value() if is_expression(f) else float(cast(Fraction, f)) for f in checked.values())
            if abs(whole - 1) > DISAGREEMENT:
                raise self._error(f"has factors that add up to {whole:.6g}, expected 1; correct them")

    def _check_words(self) -> None:
        if self.model not in FIRST_LEVEL:
            raise self._error(f"is of model {self.model!r}, expected one of {', '.join(FIRST_LEVEL)}; choose one")
        if self.testing not in TESTING:
            raise self._error(f"has testing {self.testing!r}, expected {' or '.join(TESTING)}; choose one")
        if self.size < 2:
            raise self._error(f"has {self.size} members, expected 2 or more; name all that share a cause")
        if twice := [member for member, times in Counter(self.members).items() if times > 1]:
            raise self._error(f'names "{twice[0]}" more than once; name each member once')

    def _number(self, value: Rational | Expression, what: str) -> Fraction | Expression:
        """The Fraction that `value` is, or the expression, made one variable of its own if it is uncertain."""
        if is_expression(value):
            nominal = 0.0 if value.uses_mission_time else value.value()  # over time, each event checks its own
            number: Fraction | Expression = self._shared(value, what)
        else:
            number = exact(cast(Rational, value), f"{what} of {self}", self.name)
            nominal = float(number)
        if not 0 <= nominal <= 1:
            raise self._error(f"has {what} {nominal:g}, expected 0 to 1; correct it")
        return number

    def _shared(self, expression: Expression, what: str) -> Expression:
        """Distributions are drawn once a sample wherever they stand only below a parameter."""
        from safety.trees.expressions.expression import Parameter

        if isinstance(expression, Parameter) or all(part.is_certain for part in expression.below()):
            return expression
        return Parameter(f"{what} of {self}", expression)

    @property
    def as_given(self) -> tuple[Fraction | Expression | None, dict[int, Fraction | Expression]]:
        """`total` and `factors` without the parameters that this group made of them."""

        def given(value: Any) -> Any:
            return value.definition if str(getattr(value, "name", "")).endswith(f" of {self}") else value

        return given(self.total), {level: given(factor) for level, factor in self.factors.items()}

    def __str__(self) -> str:
        return f'common cause group "{self.name}"'

    def _error(self, what: str) -> TreeError:
        return TreeError(f"{self} ({self.model}) {what}", self.name)

    @property
    def size(self) -> int:
        """The number of members, n."""
        return len(self.members)

    @property
    def shares(self) -> dict[int, Fraction | Expression]:
        """Q_k / Q by k, without those that are 0: exact, unless a factor is an expression."""
        factors: dict[int, Any] = dict(self.factors)
        one: Any = Fraction(1)
        if any(map(is_expression, factors.values())):
            from safety.trees.expressions.expression import Constant

            one = Constant(1)
            factors = {k: f if is_expression(f) else Constant(f) for k, f in factors.items()}
        ways = {k: math.comb(self.size - 1, k - 1) for k in range(1, self.size + 1)}
        match self.model, self.testing:
            case "beta-factor", _:
                shares = {1: one - factors[self.size], self.size: factors[self.size]}
            case "MGL", _:
                shares, product = {}, one
                for k in range(1, max(factors) + 1):
                    product = product * factors[k] if k > 1 else one
                    shares[k] = product * (one - factors[k + 1] if k + 1 in factors else one) / ways[k]
            case "alpha-factor", "staggered":
                whole = reduce(add, factors.values())
                shares = {k: factor / ways[k] / whole for k, factor in factors.items()}
            case "alpha-factor", _:
                whole = reduce(add, (factor * k for k, factor in factors.items()))
                shares = {k: factor * k / ways[k] / whole for k, factor in factors.items()}
            case _:
                shares = factors
        return {k: share for k, share in shares.items() if share != 0}


def is_expression(value: object) -> TypeGuard[Expression]:
    """Whether it is an expression and no number; without importing what files of plain numbers need not."""
    return hasattr(value, "arguments")


def apply(
    tree: FaultTree, groups: Iterable[CcfGroup], elsewhere: Collection[str] = (), *, of_rates: bool = False
) -> FaultTree:
    """`tree` with the common causes of `groups` in it: every member has become an OR gate of the same name.

    Member "A" is the OR of the event "A-alone" and of "CCF-A-B", "CCF-A-B-C" and so on, one for each set of members
    that may fail together. `elsewhere` names events that other trees of the study have; a member that is only there
    is none of this tree's. With `of_rates` it is the failure rates of members that are shared out, where they have one.

    Raises TreeError: a member that is no basic event, is in two groups, or whose probability is not the group's; a
    group that would become more than MOST_EVENTS events; a name that the tree already has.
    """
    events = {event.name: event for event in tree.events}
    gates: dict[str, Gate] = {}
    added: list[BasicEvent] = []
    home: dict[str, CcfGroup] = {}
    for group in groups:
        for member in group.members:
            if member in home:
                raise TreeError(
                    f'basic event "{member}" is a member of {home[member]} and of {group}; leave it in one', member
                )
            home[member] = group
            if member not in events and member not in elsewhere:
                raise TreeError(
                    f'{group} names "{member}", which is no basic event of fault tree "{tree.name}"; define it or '
                    "correct the name",
                    group.name,
                )
        inside = [events[member] for member in group.members if member in events]
        if inside:
            added += _events(group, inside, _total(group, inside, tree.mission_time_h), of_rates)
            gates |= _member_gates(group, inside)
    return replace(
        tree,
        gates=(*tree.gates, *gates.values()),
        events=(*(event for event in tree.events if event.name not in gates), *added),
    )


def _total(group: CcfGroup, members: list[BasicEvent], mission_time_h: Fraction | None) -> BasicEvent:
    """An event with the probability Q of each member."""
    first = members[0]
    if group.total is None:
        total = _of_the_mission(first, mission_time_h)
    elif is_expression(group.total):
        needs_time = mission_time_h if group.total.uses_mission_time else None
        total = BasicEvent(first.name, mission_time_h=needs_time, expression=group.total)
    else:
        total = BasicEvent(first.name, cast(Fraction, group.total))
    for member in members:
        given, expected = member.chance, total.chance
        if not _alike(given, expected) and (given is not None or group.total is None):
            raise TreeError(
                f'basic event "{member.name}" has probability {_shown(given)}, but {group}, whose members are all '
                f"alike, has {_shown(expected)}; give them the same",
                member.name,
            )
    return total


def _of_the_mission(event: BasicEvent, mission_time_h: Fraction | None) -> BasicEvent:
    """The same event; a rate over the mission becomes an expression, whose shares follow the time as well."""
    if event.probability is not None or event.rate_per_hour is None or event.mission_time_h != mission_time_h:
        return event
    from safety.trees.expressions.expression import MissionTime
    from safety.trees.expressions.lifetimes import Exponential

    law = Exponential(event.rate_per_hour, MissionTime())
    return event.changed(rate_per_hour=None, expression=law)


def _alike(one: tuple[float, float] | None, other: tuple[float, float] | None) -> bool:
    """Whether two chances are the same but for rounding."""
    return one == other or (one is not None and other is not None and math.isclose(one[0], other[0], rel_tol=1e-12))


def _shown(chance: tuple[float, float] | None) -> str:
    return "none" if chance is None else f"{chance[0]:g}"


def _sets(group: CcfGroup, members: list[BasicEvent]) -> Iterable[tuple[int, tuple[str, ...]]]:
    """Every set of members that may fail together, by size, and with at least one of `members`."""
    here = {member.name for member in members}
    for k in group.shares:
        yield from ((k, names) for names in combinations(group.members, k) if not here.isdisjoint(names))


def _name(names: tuple[str, ...]) -> str:
    return f"{names[0]}-alone" if len(names) == 1 else "-".join(("CCF", *names))


def _events(group: CcfGroup, members: list[BasicEvent], total: BasicEvent, of_rates: bool) -> list[BasicEvent]:
    count = sum(math.comb(group.size, k) for k in group.shares)
    if count > MOST_EVENTS:
        raise TreeError(
            f"{group} of {group.size} members would become {count} events, more than {MOST_EVENTS}; use a beta factor "
            "or fewer levels",
            group.name,
        )
    tags = {member.source for member in members}
    source = tags.pop() if len(tags) == 1 else "A" if "A" in tags else ""
    scale = _at_share_of_rate if of_rates else _scaled
    scaled = {k: scale(total, share) for k, share in group.shares.items()}
    return [
        replace(
            scaled[k],
            name=_name(names),
            description=f"{' and '.join(names)} fail{'' if k > 1 else 's'} {'together' if k > 1 else 'alone'} "
            f"({group.name}, {group.model})",
            source="A" if (richer := scaled[k].expression) is not None and richer.is_assumed else source,
        )
        for k, names in _sets(group, members)
    ]


def _scaled(total: BasicEvent, share: Fraction | Expression) -> BasicEvent:
    """An event with `share` times the probability of `total`, a rational where both are."""
    if share == 1:
        return total
    if isinstance(share, Fraction) and total.probability is not None:
        return BasicEvent(total.name, share * total.probability)
    formula = total.formula
    if formula is None:
        return total
    from safety.trees.expressions.expression import Constant

    factor = Constant(share) if isinstance(share, Fraction) else share
    return BasicEvent(total.name, mission_time_h=total.mission_time_h, expression=factor * formula)


def _at_share_of_rate(total: BasicEvent, share: Fraction | Expression) -> BasicEvent:
    """An event with `share` times the rate of `total`, or of its probability where it has no constant rate."""
    if total.expression is None:
        return _scaled(total, share)
    from safety.trees.expressions.expression import Constant, MissionTime
    from safety.trees.expressions.lifetimes import Exponential, constant_rate

    if (rate := constant_rate(total.expression)) is None:
        return _scaled(total, share)
    factor = Constant(share) if isinstance(share, Fraction) else share
    return BasicEvent(
        total.name, mission_time_h=total.mission_time_h, expression=Exponential(factor * rate, MissionTime())
    )


def _member_gates(group: CcfGroup, members: list[BasicEvent]) -> dict[str, Gate]:
    inputs: dict[str, list[str]] = {member.name: [] for member in members}
    for _, names in _sets(group, members):
        for member in inputs.keys() & set(names):
            inputs[member].append(_name(names))
    return {
        member.name: Gate(member.name, "or", tuple(inputs[member.name]), description=member.description)
        for member in members
    }
