"""An independent view of small equipment: expressions, faults, monitors and runs as plain Python, states enumerated.

Nothing here reads the toolkit's terms: an expression is a tuple, a state is a tuple, and a verdict comes from visiting
every state there is.  What the toolkit proves or refutes about the same equipment has to agree with it.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

Expr = tuple[Any, ...]
Env = Mapping[str, Any]

WORDS = {"x", "w", "level"}  # names of two bits; all others are wires


# --- expressions ---------------------------------------------------------------------------------------------------


def value(e: Expr, env: Env) -> Any:
    """The value of an expression; a monitor's value stands in the environment under the expression itself."""
    op, *args = e
    if op == "name":
        return env[args[0]]
    if op == "const":
        return args[0]
    if op in MONITORS:
        return env[e]  # type: ignore[index]
    v = [value(a, env) if isinstance(a, tuple) else a for a in args]
    return EVALUATE[op](*v)


EVALUATE: dict[str, Callable[..., Any]] = {
    "not": lambda a: not a,
    "and": lambda a, b: a and b,
    "or": lambda a, b: a or b,
    "xor": lambda a, b: a != b,
    "implies": lambda a, b: b if a else True,
    "select": lambda c, a, b: a if c else b,
    "bit": lambda w, i: bool(w >> i & 1),
    "is": lambda w, n: w == n,
    "lt": lambda a, b: a < b,
    "inc": lambda w: (w + 1) % 4,
    "dec": lambda w: max(w - 1, 0),
    "mix": lambda a, b: a ^ b,
    "pair": lambda h, low: 2 * h + low,
}

# a monitor: its value at the first step, its value as seen, and what it remembers for the next step
MONITORS: dict[str, tuple[Callable[..., Any], Callable[..., Any]]] = {
    "once": (lambda e: False, lambda seen, now, e: seen or now),
    "previous": (lambda e, start: start, lambda seen, now, e, start: now),
    "age": (lambda e, most: 0, lambda seen, now, e, most: min(seen + 1, most) if now else 0),
    "total": (lambda e, most: 0, lambda seen, now, e, most: min(seen + now, most)),
}


def monitors(e: Expr) -> list[Expr]:
    """The monitors in an expression, inner ones first."""
    inner = [m for a in e[1:] if isinstance(a, tuple) for m in monitors(a)]
    return [*inner, e] if e[0] in MONITORS else inner


def premises(e: Expr) -> list[Expr]:
    """What has to happen for the formula to say anything; true where it says something at every step."""
    true: Expr = ("const", True)
    if constant(e) is not None:
        return [true]
    if e[0] == "implies":
        return [("and", e[1], p) for p in premises(e[2])]
    if e[0] == "and":
        found = [p for side in e[1:] for p in premises(side)]
        return [p for p in found if p != true] or [true]
    return [true]


def constant(e: Expr) -> Any:
    """The value of an expression that is the same whatever happens; None of any other."""
    op, *args = e
    if op in ("name", *MONITORS):
        return None
    v = [constant(a) if isinstance(a, tuple) else a for a in args]
    if op in ("and", "or") and (op == "or") in v:
        return op == "or"
    if op == "select" and v[0] is not None:
        return v[1] if v[0] else v[2]
    return None if None in v else value((op, *(("const", x) for x in v)), {}) if op != "const" else v[0]


# --- faults --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Broken:
    """A fault: kind with its number, the places it acts at, when, and for how many steps at most."""

    kind: str
    number: int | None
    places: tuple[str, ...]
    onset: str
    ticks: int | None = None


def domain(place: str) -> list[Any]:
    return [0, 1, 2, 3] if place in WORDS else [False, True]


def act(fault: Broken, there: bool, progress: Any, now: bool) -> tuple[bool, Any]:
    """Whether a fault acts at a step, and its progress after it."""
    if not there:
        return False, progress
    if fault.onset == "from start":
        return True, progress
    if fault.onset == "any time":
        return (True, "on") if progress == "on" or now else (False, progress)
    if fault.onset == "intermittent":
        return now, "on" if now else progress
    assert fault.ticks is not None
    if progress == "over" or not now:
        return False, "over" if progress is not None else None
    length = (progress or 0) + 1
    return True, "over" if length == fault.ticks else length


def memories(fault: Broken, place: str) -> list[Any]:
    """What a fault may remember of a place at power-up."""
    low = domain(place)[0]
    match fault.kind:
        case "frozen":
            return domain(place)
        case "delayed":
            return [(low,) * (fault.number or 1)]
        case "missing":
            return [0]
        case "extra":
            return [False]
    return [None]


def effect(fault: Broken, place: str, active: bool, memory: Any, healthy: Any, chosen: Any) -> tuple[Any, Any]:
    """What is seen at a place, and what the fault remembers."""
    word = place in WORDS
    mask = (1 << fault.number if fault.number is not None else 3) if word else 1
    seen, after = healthy, memory
    match fault.kind:
        case "stuck0" | "open":
            seen = healthy & ~mask if word else False
        case "stuck1" | "welded":
            seen = healthy | mask if word else True
        case "flip":
            seen = healthy ^ mask if word else not healthy
        case "byzantine":
            seen = chosen
        case "frozen":
            seen, after = memory, memory if active else healthy
        case "delayed":
            seen, after = memory[-1], (healthy, *memory[:-1])
        case "missing":
            lost = active and healthy and memory < (fault.number or 1)
            seen, after = (False if lost else healthy), memory + lost
        case "extra":
            seen, after = healthy or (active and not memory), active
    return (seen if active else healthy), after


# --- equipment and claim -------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Equipment:
    """Two registers x (two bits) and y, inputs p and q, points a, w, o; what each of them is made of."""

    a: Expr
    w: Expr
    o: Expr
    x: Expr
    y: Expr
    x0: int | None  # at power-up; None: anything
    y0: bool | None
    assumed: Expr | None = None


@dataclass(frozen=True)
class Question:
    """A claim about it."""

    holds: Expr
    given: Expr | None = None
    start: Expr | None = None
    lemmas: tuple[Expr, ...] = ()
    faults: tuple[Broken, ...] = ()
    most: int | None = None
    anywhere: bool = False


State = tuple[Any, ...]  # x, y, present, progress, memory, monitors


@dataclass
class Machine:
    """Equipment with its faults and monitors, a step at a time."""

    made: Equipment
    asked: Question
    watch: list[Expr] = field(default_factory=list)
    seats: list[tuple[int, str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        q = self.asked
        formulas = [f for f in (q.holds, q.given, q.start, *q.lemmas) if f is not None]
        self.watch = list(dict.fromkeys(m for f in formulas for m in monitors(f)))
        self.seats = [(i, place) for i, fault in enumerate(q.faults) for place in fault.places]

    def starts(self) -> Iterator[State]:
        """Every power-up."""
        q, n = self.asked, len(self.asked.faults)
        most = n if q.most is None else q.most
        xs = range(4) if self.made.x0 is None or q.anywhere else [self.made.x0]
        ys = [False, True] if self.made.y0 is None or q.anywhere else [self.made.y0]
        there = [t for t in itertools.product([False, True], repeat=n) if sum(t) <= most]
        kept = list(itertools.product(*(memories(q.faults[i], place) for i, place in self.seats)))
        watched = tuple(MONITORS[m[0]][0](*m[1:]) for m in self.watch)
        for x, y, present, memory in itertools.product(xs, ys, there, kept):
            state = (x, y, present, (None,) * n, memory, watched)
            if q.start is None or value(q.start, self._before(state)):
                yield state

    def choices(self, state: State) -> Iterator[dict[Any, Any]]:
        """Every combination of inputs and of what the faults choose."""
        names: list[Any] = ["p", "q"]
        options: list[list[Any]] = [[False, True], [False, True]]
        for i, fault in enumerate(self.asked.faults):
            if fault.onset != "from start":
                names.append(("now", i))
                options.append([False, True] if state[2][i] else [False])
        for i, place in self.seats:
            if self.asked.faults[i].kind == "byzantine":
                names.append(("value", i, place))
                options.append(domain(place) if state[2][i] else domain(place)[:1])
        for combination in itertools.product(*options):
            yield dict(zip(names, combination, strict=True))

    def _before(self, state: State) -> dict[Any, Any]:
        x, y, present, progress, _, watched = state
        env: dict[Any, Any] = {"x": x, "y": y, **dict(zip(self.watch, watched, strict=True))}
        for i, fault in enumerate(self.asked.faults):
            env[f"has{i}"] = present[i]
            env[f"struck{i}"] = present[i] if fault.onset == "from start" else progress[i] is not None
        return env

    def step(self, state: State, chosen: Mapping[Any, Any]) -> tuple[dict[Any, Any], State]:
        """What is seen at a step, and the state after it."""
        _, _, present, progress, memory, _ = state
        acts = [act(f, present[i], progress[i], chosen.get(("now", i), False)) for i, f in enumerate(self.asked.faults)]
        env = self._before(state) | {"p": chosen["p"], "q": chosen["q"]}
        kept = list(memory)
        for place, expression in (("a", self.made.a), ("w", self.made.w), ("o", self.made.o)):
            seen = value(expression, env)
            for k, (i, at) in enumerate(self.seats):
                if at == place:
                    wish = chosen.get(("value", i, place))
                    seen, kept[k] = effect(self.asked.faults[i], place, acts[i][0], memory[k], seen, wish)
            env[place] = seen
        env |= {"good": env["o"], "level": env["w"]}
        watched = tuple(MONITORS[m[0]][1](env[m], value(m[1], env), *m[1:]) for m in self.watch)
        x, y = value(self.made.x, env), value(self.made.y, env)
        return env, (x, y, present, tuple(a[1] for a in acts), tuple(kept), watched)

    def allowed(self, env: Env) -> bool:
        """Whether the assumptions hold at a step."""
        return all(value(e, env) for e in (self.made.assumed, self.asked.given) if e is not None)


# --- truth ---------------------------------------------------------------------------------------------------------


@dataclass
class Truth:
    """What visiting every state tells: the first step of a violation, and of each premise; None where it never is."""

    broken: int | None
    met: list[int | None]
    transitions: int


class TooLarge(Exception):
    """More transitions than the test wants to wait for."""


def truth(machine: Machine, most: int = 60_000) -> Truth:
    """Breadth-first through all states that can be reached."""
    asked = premises(machine.asked.holds)
    found = Truth(None, [None] * len(asked), 0)
    level = set(machine.starts())
    seen: set[State] = set()
    step = 0
    while level:
        seen |= level
        after: set[State] = set()
        for state in level:
            for chosen in machine.choices(state):
                found.transitions += 1
                if found.transitions > most:
                    raise TooLarge
                env, following = machine.step(state, chosen)
                if not machine.allowed(env):
                    continue
                after.add(following)
                if found.broken is None and not value(machine.asked.holds, env):
                    found.broken = step
                for i, premise in enumerate(asked):
                    if found.met[i] is None and value(premise, env):
                        found.met[i] = step
        level, step = after - seen, step + 1
    return found
