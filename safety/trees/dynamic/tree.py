"""Dynamic fault trees: what a `FaultTree` cannot say, as the order of failures and spare parts matter.

Meaning (after M. Volk, S. Junges, J.-P. Katoen, "Fast Dynamic Fault Tree Analysis by Model Checking Techniques", IEEE
Trans. Industrial Informatics 14, 2018):

Time. Nothing is repaired. An active event fails at its rate, a dormant one at rate x dormancy. An event with a
`probability` is present from time 0 with that probability, or never; all such events fail in one instant.
Step. One event fails, then every gate above it is decided in the same instant. Gates that fail in one step fail
simultaneously. Dependent events fail in steps of their own, right after the step in which their trigger failed.
and, or, vote, inhibit. As in a static tree; `inhibit` (IEC 61025) is an "and" of an event and its conditions.
pand. Fails when all inputs have failed, none before one to its left. A tie is in order, unless `exclusive`.
por. Fails when its first input fails before all others. A tie is in order, unless `exclusive`.
spare. Uses its first input. When the one in use fails, it claims the next to the right that has not failed and that no
    other spare gate has in use, or else fails. It claims whether it is itself active or not.
Activation. Whatever has no gate above it is active. An active gate makes all its inputs active, an active spare gate
    only the one in use. What was once active stays so. Active through one gate is active.
Dependency (fdep, pdep). When the trigger fails, all dependents fail, one after the other in any order; with
    `probability` p they do so together with probability p, decided once, when the trigger fails.
seq. An input does not fail while one to its left has not failed: a step that would do so is not possible.
mutex. At most one input fails: a step in which a second fails is not possible.
    A dependent that a seq or mutex holds back fails as soon as that is possible.

What these rules leave open is the order of simultaneous dependents, and which of two spare gates that lose their units
in one step is first to claim. Where that changes the result, there is no one result: it is refused (or, if asked for,
taken in the order written).

Storm 2.0 gives the same results but in five corners. It takes exclusive for inclusive; fails a spare gate whose unit in
use cannot fail any more when one in reserve does; keeps a unit active as a whole that shares an event with the rest of
the tree; decides a seq over gates with common events by the order in which it looks at them; and, unless told that all
elements are relevant, stops looking at what has failed even where that would go on to claim units or to trigger.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from safety.trees.as_written import TreeError, exact
from safety.trees.inputs_first import inputs_first
from safety.trees.tree import BasicEvent, FaultTree, Gate

STATIC = ("and", "or", "vote", "inhibit")
ORDERED = ("pand", "por")
GATE_KINDS = (*STATIC, *ORDERED, "spare")
RESTRICTIONS = ("seq", "mutex")


@dataclass(frozen=True)
class TimedEvent:
    """A basic event with an exponential time to failure, or with a fixed probability to be there from the start.

    `dormancy` is the factor on the rate while the event is dormant: 0 cold, 1 hot. Raises TreeError: both or neither of
    rate and probability, a value out of range.
    """

    name: str
    rate_per_hour: Fraction | None = None  # >= 0
    probability: Fraction | None = None  # 0..1
    dormancy: Fraction = Fraction(1)  # >= 0

    def __post_init__(self) -> None:
        if (self.rate_per_hour is None) == (self.probability is None):
            what = "neither a rate nor a probability" if self.rate_per_hour is None else "a rate and a probability"
            raise TreeError(f'event "{self.name}" has {what}, expected one of them (lambda= or prob=)', self.name)
        for quantity, upper in (("rate_per_hour", None), ("probability", 1), ("dormancy", None)):
            value = getattr(self, quantity)
            if value is None:
                continue
            number = exact(value, f'{quantity} of event "{self.name}"', self.name)
            if number < 0 or (upper is not None and number > upper):
                expected = "0 or more" if upper is None else f"between 0 and {upper}"
                raise TreeError(f'{quantity} of event "{self.name}" is {value}, expected {expected}', self.name)
            object.__setattr__(self, quantity, number)


@dataclass(frozen=True)
class DynamicGate:
    """A gate of one of GATE_KINDS; `k` for a vote, `exclusive` for a pand or por in which a tie is out of order.

    Raises TreeError: unknown kind, no or repeated inputs, k out of range or superfluous, `exclusive` elsewhere.
    """

    name: str
    kind: str
    inputs: tuple[str, ...]
    k: int | None = None
    exclusive: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "inputs", tuple(self.inputs))
        if self.kind not in GATE_KINDS:
            raise TreeError(
                f'gate "{self.name}" is of kind {self.kind!r}, expected one of {", ".join(GATE_KINDS)}', self.name
            )
        _check_inputs("gate", self.name, self.inputs)
        count = len(self.inputs)
        if self.kind == "vote" and not (type(self.k) is int and 1 <= self.k <= count):
            raise TreeError(
                f'vote gate "{self.name}" has k = {self.k} of {count} inputs, expected 1 to {count}', self.name
            )
        if self.kind != "vote" and self.k is not None:
            raise TreeError(f'gate "{self.name}" ({self.kind}) has k = {self.k}, which only a vote has', self.name)
        if self.exclusive and self.kind not in ORDERED:
            raise TreeError(f'gate "{self.name}" ({self.kind}) cannot be exclusive, only pand and por can', self.name)


@dataclass(frozen=True)
class Dependency:
    """When `trigger` fails, all `dependents` (events) fail with `probability`.

    Raises TreeError: no or repeated dependents, its own dependent, a probability out of range.
    """

    name: str
    trigger: str
    dependents: tuple[str, ...]
    probability: Fraction = Fraction(1)

    def __post_init__(self) -> None:
        object.__setattr__(self, "dependents", tuple(self.dependents))
        _check_inputs("dependency", self.name, self.dependents)
        if self.trigger in self.dependents:
            raise TreeError(f'dependency "{self.name}" has its trigger "{self.trigger}" as a dependent', self.name)
        number = exact(self.probability, f'probability of dependency "{self.name}"', self.name)
        if not 0 <= number <= 1:
            raise TreeError(f'probability of dependency "{self.name}" is {number}, expected between 0 and 1', self.name)
        object.__setattr__(self, "probability", number)


@dataclass(frozen=True)
class Restriction:
    """A seq or mutex over `inputs`. Raises TreeError: unknown kind, fewer than 2 or repeated inputs."""

    name: str
    kind: str
    inputs: tuple[str, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "inputs", tuple(self.inputs))
        if self.kind not in RESTRICTIONS:
            raise TreeError(f'restriction "{self.name}" is of kind {self.kind!r}, expected seq or mutex', self.name)
        _check_inputs(self.kind, self.name, self.inputs, least=2)


def _check_inputs(what: str, name: str, inputs: tuple[str, ...], least: int = 1) -> None:
    if len(inputs) < least:
        raise TreeError(f'{what} "{name}" has {len(inputs)} inputs, expected at least {least}', name)
    if repeated := [one for one, times in Counter(inputs).items() if times > 1]:
        raise TreeError(f'{what} "{name}" has the input "{repeated[0]}" more than once; name each input once', name)


Element = TimedEvent | DynamicGate | Dependency | Restriction


@dataclass(frozen=True)
class DynamicTree:
    """A top gate with what is below it, dependencies and restrictions. For their meaning see the head of this module.

    Raises TreeError: duplicate or undefined name, cycle, a dependent or trigger of the wrong sort, two spare gates with
    the same first input, a top that is no gate.
    """

    name: str
    top: str
    gates: tuple[DynamicGate, ...]
    events: tuple[TimedEvent, ...]
    dependencies: tuple[Dependency, ...] = ()
    restrictions: tuple[Restriction, ...] = ()

    def __post_init__(self) -> None:
        for part in ("gates", "events", "dependencies", "restrictions"):
            object.__setattr__(self, part, tuple(getattr(self, part)))
        named: tuple[Element, ...] = (*self.gates, *self.events, *self.dependencies, *self.restrictions)
        for name, times in Counter(element.name for element in named).items():
            if times > 1:
                raise TreeError(f'"{name}" is defined {times} times; rename or remove all but one', name)
        if not isinstance(self.nodes.get(self.top), DynamicGate):
            known = f"name one of the gates: {', '.join(g.name for g in self.gates[:9])}" if self.gates else "add one"
            raise TreeError(f'the top "{self.top}" is no gate; {known}', self.top)
        for gate in self.gates:
            self._check_known(gate.name, gate.inputs)
        for restriction in self.restrictions:
            self._check_known(restriction.name, restriction.inputs)
        for dependency in self.dependencies:
            self._check_known(dependency.name, (dependency.trigger, *dependency.dependents))
            for name in dependency.dependents:
                if isinstance(self.nodes[name], DynamicGate):
                    raise TreeError(
                        f'dependency "{dependency.name}" has the gate "{name}" as a dependent, expected basic events; '
                        "name the events below it",
                        dependency.name,
                    )
        first: dict[str, str] = {}
        for gate in self.gates:
            if gate.kind == "spare" and (other := first.setdefault(gate.inputs[0], gate.name)) != gate.name:
                raise TreeError(
                    f'spare gates "{other}" and "{gate.name}" both begin with "{gate.inputs[0]}", which only one of '
                    "them can use; give each a first input of its own",
                    gate.name,
                )
        self._inputs_first(gate.name for gate in self.gates)

    def _check_known(self, user: str, names: Iterable[str]) -> None:
        for name in names:
            if name not in self.nodes:
                raise TreeError(
                    f'"{user}" uses "{name}", which is neither a gate nor an event; define it or correct the name', user
                )

    @cached_property
    def nodes(self) -> Mapping[str, DynamicGate | TimedEvent]:
        """Every gate and event by name."""
        nodes: tuple[DynamicGate | TimedEvent, ...] = (*self.gates, *self.events)
        return {node.name: node for node in nodes}

    @cached_property
    def inputs_first(self) -> tuple[DynamicGate, ...]:
        """All gates, each after its inputs, otherwise in the order written."""
        return self._inputs_first(gate.name for gate in self.gates)

    def _inputs_first(self, roots: Iterable[str]) -> tuple[DynamicGate, ...]:
        return inputs_first({gate.name: gate for gate in self.gates}, roots, "cycle of gates")

    @cached_property
    def below(self) -> Mapping[str, frozenset[str]]:
        """For every gate and event: itself and all that is below it."""
        found = {event.name: frozenset([event.name]) for event in self.events}
        for gate in self.inputs_first:
            found[gate.name] = frozenset([gate.name]).union(*(found[name] for name in gate.inputs))
        return found

    @property
    def dynamic_elements(self) -> tuple[str, ...]:
        """What a static tree cannot hold: names of pand, por and spare gates, dependencies and restrictions."""
        gates = [gate.name for gate in self.gates if gate.kind not in STATIC]
        return (*gates, *(d.name for d in self.dependencies), *(r.name for r in self.restrictions))

    def static(self, mission_time_h: Fraction | None = None) -> FaultTree:
        """The same as a static tree, for events with rates at `mission_time_h` (hours).

        Raises TreeError when it has a dynamic element, or a rate and no time is given.
        """
        if self.dynamic_elements:
            item = self.dynamic_elements[0]
            raise TreeError(
                f'"{self.name}" is a dynamic tree ("{item}" depends on the order of failures), expected a static one; '
                "solve it with solve_dynamic",
                item,
            )
        return FaultTree(
            self.name,
            self.top,
            tuple(Gate(g.name, "and" if g.kind == "inhibit" else g.kind, g.inputs, g.k) for g in self.gates),
            tuple(BasicEvent(e.name, e.probability, e.rate_per_hour) for e in self.events),
            mission_time_h=mission_time_h,
        )

    @classmethod
    def of(cls, tree: FaultTree) -> DynamicTree:
        """The static `tree` as a dynamic one. Raises TreeError: a not or xor gate, an event without rate or chance."""
        for event in tree.events:
            if event.probability is None and event.rate_per_hour is None:
                what = "no probability" if event.expression is None else "an expression as its probability"
                raise TreeError(
                    f'event "{event.name}" has {what}, which Galileo text cannot hold; give it a number or a rate, or '
                    "write the tree as .json or .xml",
                    event.name,
                )
        for gate in tree.gates:
            if gate.kind not in STATIC:
                raise TreeError(f'gate "{gate.name}" is a {gate.kind}, expected and, or, vote only', gate.name)
        houses = [TimedEvent(h.name, probability=Fraction(h.state)) for h in tree.house_events]
        events = [
            TimedEvent(e.name, None if e.probability is not None else e.rate_per_hour, e.probability)
            for e in tree.events
        ]
        gates = [DynamicGate(g.name, g.kind, g.inputs, g.k) for g in tree.gates]
        return cls(tree.name, tree.top, tuple(gates), (*events, *houses))
