"""Fault trees: basic events, house events, gates and the tree that holds them.

Units: probabilities 0..1 without unit, failure rates per hour, times in hours. Numbers are kept exactly as written:
the text "0.01", the number 0.01 and Fraction(1, 100) are the same rational. Every number that came from somewhere
carries a source tag: P printed, D derived, A assumed, R reconstructed.

Vocabulary and gate meanings follow IEC 61025:2006; "vote" is its k-out-of-n gate.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from fractions import Fraction
from functools import cached_property

from safety.trees.as_written import TreeError, exact
from safety.trees.inputs_first import inputs_first
from safety.trees.record import Record

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from safety.trees.expressions.expression import Expression

KINDS = ("and", "or", "vote", "not", "xor")
TAGS = {"P": "printed", "D": "derived", "A": "assumed", "R": "reconstructed", "": "untagged"}
HALF_ULP = 2.0**-53  # the largest relative error of one rounding
LARGEST = 10**150  # rate per hour or mission time; their product is still a double
DISAGREEMENT = Fraction(1, 100)  # allowed between a probability and the rate beside it, as printed figures are rounded


class BasicEvent(Record):
    """A cause that is not analysed further.

    Its probability is `probability`, or 1 - exp(-rate_per_hour * mission_time_h), or the value of `expression` at the
    mission time, or unknown (None) when none is given. A rate may stand beside a probability for the reader; the
    probability is then used, and the two must agree within 1 %.

    Raises TreeError: value out of range, rate and probability in disagreement, an expression beside them, unknown
    source tag.
    """

    name: str
    probability: Fraction | None = None  # 0..1
    rate_per_hour: Fraction | None = None  # >= 0
    mission_time_h: Fraction | None = None  # >= 0
    description: str = ""
    source: str = ""  # a key of TAGS
    attributes: tuple[tuple[str, str], ...] = ()  # names and texts that mean nothing here, kept for other programs
    expression: Expression | None = None

    def __post_init__(self) -> None:
        for quantity, upper in (("probability", 1), ("rate_per_hour", None), ("mission_time_h", None)):
            value = getattr(self, quantity)
            if value is None:
                continue
            number = value
            if type(value) is not Fraction:
                number = exact(value, f'{quantity} of basic event "{self.name}"', self.name)
                object.__setattr__(self, quantity, number)
            over, under = number.numerator, number.denominator  # compared in whole numbers, which is quick
            if over < 0 or (upper and over > under):
                expected = "between 0 and 1" if upper else "0 or more"
                raise TreeError(
                    f'{quantity} of basic event "{self.name}" is {value}, expected {expected}; correct it', self.name
                )
            if not upper and over > LARGEST * under:
                raise TreeError(
                    f'{quantity} of basic event "{self.name}" is about 1e{len(str(int(number))) - 1}, expected at most '
                    f"{float(LARGEST):.0e}, beyond which no double holds what follows from it; correct it",
                    self.name,
                )
        if self.source not in TAGS:
            raise TreeError(
                f'source tag of basic event "{self.name}" is {self.source!r}, expected P (printed), D (derived), '
                "A (assumed), R (reconstructed) or nothing; choose one",
                self.name,
            )
        if self.probability is not None and self.rate_per_hour is not None and self.mission_time_h is not None:
            by_rate = -math.expm1(-float(self.rate_per_hour * self.mission_time_h))
            if abs(by_rate - self.probability) > DISAGREEMENT * self.probability:
                raise TreeError(
                    f'basic event "{self.name}" has probability {float(self.probability):g}, but its rate and mission '
                    f"time give {by_rate:g}; remove one of them or correct it",
                    self.name,
                )
        if self.expression is not None:
            self._check_expression(self.expression)

    def _check_expression(self, expression: Expression) -> None:
        if self.probability is not None or self.rate_per_hour is not None:
            raise TreeError(
                f'basic event "{self.name}" has an expression besides a probability or rate; remove one of them',
                self.name,
            )
        if expression.uses_mission_time and self.mission_time_h is None:
            return
        try:
            value = expression.value(self.mission_time_h)
            possible = 0 <= value <= 1
            if not possible:  # or a rounding error beyond the end
                low, high = expression.enclosure(self.mission_time_h)
                possible = low <= 1 and high >= 0
        except TreeError as error:
            raise TreeError(f'basic event "{self.name}": {error.message}', self.name, error.place) from None
        if not possible:
            raise TreeError(
                f'the expression of basic event "{self.name}" gives {value:g}, expected a probability between 0 and 1; '
                "correct it",
                self.name,
            )

    @property
    def formula(self) -> Expression | None:
        """What gives its probability, as an expression; None if it is unknown."""
        from safety.trees.expressions.expression import Constant
        from safety.trees.expressions.lifetimes import Exponential

        if self.expression is not None:
            return self.expression
        if self.probability is not None:
            return Constant(self.probability)
        if self.rate_per_hour is None or self.mission_time_h is None:
            return None
        return Exponential(self.rate_per_hour, self.mission_time_h)

    @cached_property
    def exact_chance(self) -> tuple[Fraction, Fraction] | None:
        """Probability that the event occurs and that it does not, as rationals;

        None if these are unknown or irrational.
        """
        if self.probability is not None:
            return self.probability, 1 - self.probability
        if self._is_expressed:
            assert self.expression is not None
            value = self.expression.exact(self.mission_time_h)
            return None if value is None else (value, 1 - value)
        return (Fraction(0), Fraction(1)) if self._expected_failures == 0 else None

    @cached_property
    def chance(self) -> tuple[float, float] | None:
        """The same in double precision, both as accurate as `chance_error` says; None if unknown."""
        if self.probability is not None:  # as by far the most are: without a Fraction made anew
            over, under = self.probability.numerator, self.probability.denominator
            return over / under, (under - over) / under
        exactly = self.exact_chance
        if exactly is not None:
            return float(exactly[0]), float(exactly[1])
        if self._is_expressed:
            assert self.expression is not None
            value, rest = self.expression.chance(self.mission_time_h)
            return min(max(value, 0.0), 1.0), min(max(rest, 0.0), 1.0)
        if self._expected_failures is None:
            return None
        exponent = -float(self._expected_failures)
        return -math.expm1(exponent), math.exp(exponent)

    @property
    def chance_error(self) -> float:
        """A bound of the relative error of either number of `chance`; infinite where an expression gives none.

        With a math library good to 1 ulp, at most 3 half ulps for 1 - exp(-x) and 3 + x for exp(-x).
        """
        if self.probability is not None or self.exact_chance is not None or self.chance is None:
            return HALF_ULP
        if self.expression is None:
            assert self._expected_failures is not None
            return HALF_ULP * (3 + float(self._expected_failures))
        low, high = self.enclosure
        if low == high:
            return HALF_ULP
        return (high - low) / min(low, 1 - high) if low > 0 and high < 1 else math.inf

    @property
    def enclosure(self) -> tuple[float, float]:
        """Doubles between which the probability lies, within 0..1; 0 and 1 where nothing is known."""
        if self._is_expressed:
            assert self.expression is not None
            low, high = self.expression.enclosure(self.mission_time_h)
            return max(0.0, low), min(1.0, high)
        if self.chance is None:
            return 0.0, 1.0
        value, error = self.chance[0], 8 * HALF_ULP  # of the 3 that `chance_error` tells for it
        return max(0.0, value * (1 - error)), min(1.0, value * (1 + error))

    @property
    def _is_expressed(self) -> bool:
        """Whether an expression gives the probability, and all that it needs is known."""
        return self.expression is not None and (
            self.mission_time_h is not None or not self.expression.uses_mission_time
        )

    @property
    def _expected_failures(self) -> Fraction | None:
        return (
            None
            if self.rate_per_hour is None or self.mission_time_h is None
            else self.rate_per_hour * self.mission_time_h
        )


class HouseEvent(Record):
    """A condition that holds (`state` True) or not throughout: a constant, never part of a cut set."""

    name: str
    state: bool
    description: str = ""
    attributes: tuple[tuple[str, str], ...] = ()


class Gate(Record):
    """A gate over `inputs`, the names of gates and events: and, or, vote (at least `k`), not (one input), xor (an odd
    number).

    Raises TreeError: unknown kind, wrong number of inputs, an input given twice, k missing, superfluous or out of
    range.
    """

    name: str
    kind: str
    inputs: tuple[str, ...]
    k: int | None = None
    description: str = ""
    inside: str = ""  # the gate in whose formula this one was written, if it had no name of its own
    attributes: tuple[tuple[str, str], ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "inputs", tuple(self.inputs))
        count = len(self.inputs)
        if self.kind not in KINDS:
            raise self._error(f"is of kind {self.kind!r}, expected one of {', '.join(KINDS)}; rewrite it with these")
        if count == 0 or (self.kind == "not" and count != 1):
            raise self._error(
                f"has {count} inputs, expected {'exactly 1' if self.kind == 'not' else 'at least 1'}; correct its list"
            )
        if len(set(self.inputs)) < count:
            repeated = next(name for name, times in Counter(self.inputs).items() if times > 1)
            raise self._error(f'has the input "{repeated}" more than once; name each input once')
        if self.kind == "vote" and not (type(self.k) is int and 1 <= self.k <= count):
            raise self._error(
                f"has k = {self.k!r} of {count} inputs, expected a whole number from 1 to {count}; "
                "correct k or the inputs"
            )
        if self.kind != "vote" and self.k is not None:
            raise self._error(f'has k = {self.k} but is no vote; remove k or make it a "vote"')

    def _error(self, what: str) -> TreeError:
        return TreeError(f'gate "{self.name}" ({self.kind}) {what}', self.name)


Node = Gate | BasicEvent | HouseEvent


class FaultTree(Record):
    """A top gate and everything below it, checked when made.

    An event with a rate and no mission time of its own takes `mission_time_h` of the tree (hours). Gates and events
    that the top does not reach are kept and have no influence.

    Raises TreeError: duplicate or undefined name, a cycle (its gates are named), no such top gate, a rate without a
    mission time.
    """

    name: str
    top: str
    gates: tuple[Gate, ...]
    events: tuple[BasicEvent, ...]
    house_events: tuple[HouseEvent, ...] = ()
    description: str = ""
    mission_time_h: Fraction | None = None

    def __post_init__(self) -> None:
        if self.mission_time_h is not None:
            time = exact(self.mission_time_h, f'mission_time_h of fault tree "{self.name}"')
            if time < 0:
                raise TreeError(
                    f'mission_time_h of fault tree "{self.name}" is {time}, expected 0 or more hours; correct it'
                )
            object.__setattr__(self, "mission_time_h", time)
        object.__setattr__(self, "gates", tuple(self.gates))
        object.__setattr__(self, "events", tuple(self._with_mission_time(event) for event in self.events))
        object.__setattr__(self, "house_events", tuple(self.house_events))
        self._check_names()
        self._inputs_first(gate.name for gate in self.gates)

    def _with_mission_time(self, event: BasicEvent) -> BasicEvent:
        if event.mission_time_h is not None:
            return event
        if event.expression is not None and event.expression.uses_mission_time:
            has = "an expression of the mission time"
        elif event.rate_per_hour is not None:
            has = f"a rate of {float(event.rate_per_hour):g} per hour"
        else:
            return event
        if self.mission_time_h is None and event.probability is None:
            raise TreeError(
                f'basic event "{event.name}" has {has} and no mission time; give it mission_time_h, or give one to the '
                f'fault tree "{self.name}" (--hours on the command line)',
                event.name,
            )
        return event.changed(mission_time_h=self.mission_time_h)

    def _check_names(self) -> None:
        every: tuple[Node, ...] = (*self.gates, *self.events, *self.house_events)
        nodes = self.nodes
        if len(nodes) < len(every):
            name, times = next(some for some in Counter(node.name for node in every).items() if some[1] > 1)
            raise TreeError(
                f'"{name}" is defined {times} times in fault tree "{self.name}"; rename or remove all but one', name
            )
        for gate in self.gates:
            for name in gate.inputs:
                if name not in nodes:
                    raise TreeError(
                        f'gate "{gate.name}" has the input "{name}", which is neither a gate nor an event of fault '
                        f'tree "{self.name}"; define it or correct the name',
                        gate.name,
                    )
        if not isinstance(self.nodes.get(self.top), Gate):
            raise TreeError(
                f'fault tree "{self.name}" has no gate "{self.top}" to be its top; '
                + ("name one of its gates" if self.gates else "it has none; define it")
            )

    @cached_property
    def nodes(self) -> Mapping[str, Node]:
        """Every gate, basic event and house event by name."""
        nodes: tuple[Node, ...] = (*self.gates, *self.events, *self.house_events)
        return {node.name: node for node in nodes}

    @property
    def is_monotone(self) -> bool:
        """Whether no gate negates, so that events can only cause the top event."""
        return all(gate.kind in ("and", "or", "vote") for gate in self.gates)

    @cached_property
    def inputs_first(self) -> tuple[Gate, ...]:
        """The gates that the top reaches, each after its inputs; the top is last."""
        return self._inputs_first([self.top])

    def _inputs_first(self, roots: Iterable[str]) -> tuple[Gate, ...]:
        gates = {gate.name: gate for gate in self.gates}
        return inputs_first(gates, roots, f'fault tree "{self.name}" has a cycle')

    def occurs(self, failed: Collection[str]) -> bool:
        """Whether the top event occurs when exactly the basic events in `failed` do: the plain reading of the gates."""
        truth = {event.name: event.name in failed for event in self.events} | {
            h.name: h.state for h in self.house_events
        }
        for gate in self.inputs_first:
            count = sum(truth[name] for name in gate.inputs)
            match gate.kind:
                case "and":
                    truth[gate.name] = count == len(gate.inputs)
                case "or":
                    truth[gate.name] = count > 0
                case "vote":
                    assert gate.k is not None
                    truth[gate.name] = count >= gate.k
                case "not":
                    truth[gate.name] = count == 0
                case _:
                    truth[gate.name] = count % 2 == 1
        return truth[self.top]
