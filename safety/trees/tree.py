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
from dataclasses import dataclass, field, replace
from decimal import Decimal
from fractions import Fraction
from functools import cached_property

Rational = Fraction | int | float | str | Decimal
KINDS = ("and", "or", "vote", "not", "xor")
TAGS = {"P": "printed", "D": "derived", "A": "assumed", "R": "reconstructed", "": "untagged"}
LARGEST_EXPONENT = 400  # of ten, in a number as written; beyond any double, and small enough to compute with
DISAGREEMENT = Fraction(1, 100)  # allowed between a probability and the rate beside it, as printed figures are rounded


class TreeError(ValueError):
    """What was given is no fault tree: `item` is the event or gate at fault, `place` the "file:line" if it was read."""

    exit_code = 2

    def __init__(self, message: str, item: str = "", place: str = "") -> None:
        super().__init__(f"{place}: {message}" if place else message)
        self.message, self.item, self.place = message, item, place


def exact(value: Rational, what: str, item: str = "") -> Fraction:
    """The rational that `value` was written as; a float means the decimal it prints as.

    Raises TreeError when it is no finite number.
    """
    text = str(value)
    try:
        if abs(int(text.lower().partition("e")[2] or 0)) <= LARGEST_EXPONENT and not isinstance(value, bool):
            return Fraction(text)
    except (ValueError, ZeroDivisionError):
        pass
    raise TreeError(f"{what} is {text[:40]!r}, expected a number such as 0.01, 1e-6 or 1/3; correct it", item)


@dataclass(frozen=True)
class BasicEvent:
    """A cause that is not analysed further.

    Its probability is `probability`, or 1 - exp(-rate_per_hour * mission_time_h), or unknown (None) when neither is
    given. A rate may stand beside a probability for the reader; the probability is then used, and the two must agree
    within 1 %.

    Raises TreeError: value out of range, rate and probability in disagreement, unknown source tag.
    """

    name: str
    probability: Fraction | None = None  # 0..1
    rate_per_hour: Fraction | None = None  # >= 0
    mission_time_h: Fraction | None = None  # >= 0
    description: str = ""
    source: str = ""  # a key of TAGS

    def __post_init__(self) -> None:
        for quantity, upper in (("probability", 1), ("rate_per_hour", None), ("mission_time_h", None)):
            value = getattr(self, quantity)
            if value is None:
                continue
            number = exact(value, f'{quantity} of basic event "{self.name}"', self.name)
            if number < 0 or (upper is not None and number > upper):
                expected = "between 0 and 1" if upper else "0 or more"
                raise TreeError(
                    f'{quantity} of basic event "{self.name}" is {value}, expected {expected}; correct it', self.name
                )
            object.__setattr__(self, quantity, number)
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

    @property
    def exact_chance(self) -> tuple[Fraction, Fraction] | None:
        """Probability that the event occurs and that it does not, as rationals;

        None if these are unknown or irrational.
        """
        if self.probability is not None:
            return self.probability, 1 - self.probability
        return (Fraction(0), Fraction(1)) if self._expected_failures == 0 else None

    @property
    def chance(self) -> tuple[float, float] | None:
        """The same in double precision, both accurate to an ulp or two; None if unknown."""
        if self.exact_chance is not None:
            return float(self.exact_chance[0]), float(self.exact_chance[1])
        if self._expected_failures is None:
            return None
        exponent = -float(self._expected_failures)
        return -math.expm1(exponent), math.exp(exponent)

    @property
    def _expected_failures(self) -> Fraction | None:
        return (
            None
            if self.rate_per_hour is None or self.mission_time_h is None
            else self.rate_per_hour * self.mission_time_h
        )


@dataclass(frozen=True)
class HouseEvent:
    """A condition that holds (`state` True) or not throughout: a constant, never part of a cut set."""

    name: str
    state: bool
    description: str = ""


@dataclass(frozen=True)
class Gate:
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

    def __post_init__(self) -> None:
        object.__setattr__(self, "inputs", tuple(self.inputs))
        count = len(self.inputs)
        if self.kind not in KINDS:
            raise self._error(f"is of kind {self.kind!r}, expected one of {', '.join(KINDS)}; rewrite it with these")
        if count == 0 or (self.kind == "not" and count != 1):
            raise self._error(
                f"has {count} inputs, expected {'exactly 1' if self.kind == 'not' else 'at least 1'}; correct its list"
            )
        if repeated := [name for name, times in Counter(self.inputs).items() if times > 1]:
            raise self._error(f'has the input "{repeated[0]}" more than once; name each input once')
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


@dataclass(frozen=True)
class FaultTree:
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
    mission_time_h: Fraction | None = field(default=None, repr=False)

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
        if event.rate_per_hour is None or event.mission_time_h is not None:
            return event
        if self.mission_time_h is None and event.probability is None:
            raise TreeError(
                f'basic event "{event.name}" has a rate of {float(event.rate_per_hour):g} per hour and no mission '
                f'time; give it mission_time_h, or give one to the fault tree "{self.name}"',
                event.name,
            )
        return replace(event, mission_time_h=self.mission_time_h)

    def _check_names(self) -> None:
        nodes: tuple[Node, ...] = (*self.gates, *self.events, *self.house_events)
        for name, times in Counter(node.name for node in nodes).items():
            if times > 1:
                raise TreeError(
                    f'"{name}" is defined {times} times in fault tree "{self.name}"; rename or remove all but one', name
                )
        for gate in self.gates:
            for name in gate.inputs:
                if name not in self.nodes:
                    raise TreeError(
                        f'gate "{gate.name}" has the input "{name}", which is neither a gate nor an event of fault '
                        f'tree "{self.name}"; define it or correct the name',
                        gate.name,
                    )
        if not isinstance(self.nodes.get(self.top), Gate):
            raise TreeError(
                f'fault tree "{self.name}" has no gate "{self.top}" to be its top; '
                f"name one of its {len(self.gates)} gates"
            )

    @cached_property
    def nodes(self) -> Mapping[str, Node]:
        """Every gate, basic event and house event by name."""
        nodes: tuple[Node, ...] = (*self.gates, *self.events, *self.house_events)
        return {node.name: node for node in nodes}

    @cached_property
    def inputs_first(self) -> tuple[Gate, ...]:
        """The gates that the top reaches, each after its inputs; the top is last."""
        return self._inputs_first([self.top])

    def _inputs_first(self, roots: Iterable[str]) -> tuple[Gate, ...]:
        done: dict[str, Gate] = {}
        path: dict[str, None] = {}  # gates entered and not yet left, outermost first
        agenda = [(root, False) for root in roots][::-1]
        while agenda:
            name, leaving = agenda.pop()
            gate = self.nodes[name]
            if not isinstance(gate, Gate) or name in done:
                continue
            if leaving:
                del path[name]
                done[name] = gate
            elif name in path:
                open_gates = list(path)
                loop = " -> ".join([*open_gates[open_gates.index(name) :], name])
                raise TreeError(
                    f'fault tree "{self.name}" has a cycle: {loop}; no gate may be its own cause, break it at one of '
                    "them",
                    name,
                )
            else:
                path[name] = None
                agenda.append((name, True))
                agenda.extend((below, False) for below in reversed(gate.inputs))
        return tuple(done.values())

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
