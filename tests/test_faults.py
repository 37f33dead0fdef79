"""Fault kinds and onsets: what a run shows, and that every reading of a faulty model is the same machine."""

from __future__ import annotations

import random
from dataclasses import replace
from typing import Any, NamedTuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety.faults import (
    ANY_TIME,
    FROM_START,
    INTERMITTENT,
    TRANSIENT,
    Fault,
    any_active,
    any_of_faults,
    at_most,
    byzantine,
    delayed,
    every,
    expand,
    extra,
    flip,
    frozen,
    instrument,
    missing,
    now_name,
    open_circuit,
    present_name,
    schedule,
    stuck,
    together,
    welded,
    within,
)
from safety.model import Model, point, power_up
from safety.prove.claims import REFUTED, Claim
from safety.prove.prove import Limits, prove
from safety.system import ANY, ModelError, System, repeat
from safety.terms import U2, U4, Bit, Int, Real, bit
from safety.terms.direct import evaluate
from safety.terms.graph import describe
from safety.trace import run
from safety.tracing import trace
from tests.kinds.readings import reading
from tests.prove import chance, naive, translated
from tests.prove.naive import Broken, Machine, Question

# --- what each kind does, in words that can be checked by eye ------------------------------------------------------


class Seen(NamedTuple):
    wire: Bit
    word: U4


class Line(Model, event="tick"):
    """Passes a wire and a word on."""

    def step(self, w: Bit, n: U4) -> tuple[Line, Seen]:
        return Line(), Seen(wire=point("wire", w), word=point("word", n))


def wires(fault: Fault, text: str) -> str:
    """What is seen of a wire."""
    system = instrument(trace(Line), [fault])
    choose = schedule(system)
    found = run(system.system, lambda k: {"w": text[k] == "1", "n": 0, **choose(k)}, len(text))["wire"]
    return "".join(str(int(v)) for v in found)


def words(fault: Fault, *values: int, start: dict[str, Any] | None = None) -> list[int]:
    """What is seen of a word."""
    system = instrument(trace(Line), [fault])
    choose = schedule(system)
    return run(system.system, lambda k: {"w": False, "n": values[k], **choose(k)}, len(values), start=start)["word"]


@pytest.mark.parametrize(
    ("fault", "healthy", "seen"),
    [
        (Fault(stuck(0), ["wire"]), "0110", "0000"),
        (Fault(stuck(1), ["wire"]), "0110", "1111"),
        (Fault(open_circuit(), ["wire"], ANY_TIME, at=2), "1111", "1100"),
        (Fault(welded(), ["wire"], TRANSIENT, at=1, ticks=2), "00000", "01100"),
        (Fault(flip(), ["wire"], INTERMITTENT, at=1, ticks=2), "0110", "0000"),
        (Fault(frozen(), ["wire"], ANY_TIME, at=2), "0101010", "0111111"),
        (Fault(frozen(), ["wire"], TRANSIENT, at=2, ticks=2), "0100011", "0111011"),
        (Fault(frozen(), ["wire"]), "111", "000"),
        (Fault(delayed(2), ["wire"]), "1101000", "0011010"),
        (Fault(delayed(1), ["wire"], ANY_TIME, at=2), "0110", "0111"),
        (Fault(missing(2), ["wire"]), "0101011", "0000011"),
        (Fault(missing(1), ["wire"], ANY_TIME, at=2), "1101", "1100"),
        (Fault(extra(), ["wire"], ANY_TIME, at=2), "0000", "0010"),
        (Fault(extra(), ["wire"]), "0000", "1000"),
        (Fault(byzantine(), ["wire"], values={"wire": [True, False, True]}), "0000", "1011"),
        (Fault(byzantine(), ["wire"]), "1111", "0000"),
    ],
    ids=lambda v: str(v) if isinstance(v, Fault) else "",
)
def test_what_is_seen_of_a_wire(fault: Fault, healthy: str, seen: str) -> None:
    assert wires(fault, healthy) == seen


def test_what_is_seen_of_a_word() -> None:
    assert words(Fault(stuck(1, bit=3), ["word"]), 0, 9, 7) == [8, 9, 15]
    assert words(Fault(stuck(0, bit=0), ["word"]), 0, 9, 7) == [0, 8, 6]
    assert words(Fault(stuck(1), ["word"]), 0, 9) == [15, 15]
    assert words(Fault(flip(), ["word"]), 0, 9) == [15, 6]
    assert words(Fault(flip(bit=1), ["word"], TRANSIENT, at=1, ticks=1), 0, 0, 0) == [0, 2, 0]
    assert words(Fault(frozen(), ["word"]), 1, 2, start={"fault0.word.last": 9}) == [9, 9]
    assert words(Fault(delayed(3), ["word"]), 1, 2, 3, 4, 5) == [0, 0, 0, 1, 2]
    assert words(Fault(byzantine(), ["word"], ANY_TIME, at=1, values={"word": [3, 4, 5]}), 9, 9, 9, 9) == [9, 4, 5, 5]


def test_faults_at_one_point_act_in_their_order() -> None:
    line = trace(Line)

    def both(*order: Fault) -> Any:
        system = instrument(line, order).system
        return run(system, {"w": True, "n": 0}, 1)["wire"][0]

    assert both(Fault(stuck(0), ["wire"]), Fault(flip(), ["wire"])) is True
    assert both(Fault(flip(), ["wire"]), Fault(stuck(0), ["wire"])) is False


# --- one machine in every reading ----------------------------------------------------------------------------------


@given(st.integers(0, 10**6), st.sampled_from(chance.KINDS), st.sampled_from(chance.ONSETS))
def test_readings_and_the_naive_machine_agree(seed: int, kind: str, onset: str) -> None:
    rng = random.Random(seed)
    asked = Question(("const", True), faults=(chance.broken(rng, kind, onset), chance.broken(rng)))
    machine = Machine(chance.equipment(rng), asked)
    broken = [translated.fault(f, i) for i, f in enumerate(asked.faults)]
    system = instrument(trace(translated.model(machine.made)), broken, present=None).system
    state = rng.choice(list(machine.starts()))
    values = _start(system, machine, state)
    for _ in range(6):
        chosen = rng.choice(list(machine.choices(state)))
        env, state = machine.step(state, chosen)
        row = [*values, *(_chosen(name, chosen) for name in system.inputs)]
        after = reading(system, row)
        seen = dict(zip([*system.signals, *system.points], after[len(values) :], strict=True))
        assert seen == {name: env[name] for name in seen}
        values = list(after[: len(values)])
        assert dict(zip(system.state, values, strict=True)).items() >= {"x": state[0], "y": state[1]}.items()


def _start(system: System, machine: Machine, state: naive.State) -> list[Any]:
    x, y, present, _, memory, _ = state
    last = {f"fault{i}.{place}.last": memory[k] for k, (i, place) in enumerate(machine.seats)}
    known = {"x": x, "y": y, **{present_name(i): p for i, p in enumerate(present)}, **last}
    return [known[s.path] if s.power_up is ANY else s.power_up for s in system.states]


def _chosen(name: str, chosen: dict[Any, Any]) -> Any:
    if name in ("p", "q"):
        return chosen[name]
    index, *place = name.removeprefix("fault").split(".")
    return chosen.get(("now", int(index)), False) if place == ["now"] else chosen["value", int(index), place[0]]


@pytest.mark.parametrize("onset", chance.ONSETS)
@pytest.mark.parametrize("kind", chance.KINDS)
def test_the_solver_finds_what_the_schedule_shows(kind: str, onset: str) -> None:
    """A fault on a schedule and a fault that the solver times reach the same strange values, at the same first step."""
    broken = Broken(
        kind, 1 if kind in ("delayed", "missing") else None, ("o",), onset, 2 if onset == TRANSIENT else None
    )
    toggles = naive.Equipment(
        a=("name", "p"),
        w=("name", "x"),
        o=("bit", ("name", "x"), 0),
        x=("inc", ("name", "x")),
        y=("name", "y"),
        x0=0,
        y0=False,
    )
    model = translated.model(toggles)

    def strange(s: Any) -> Bit:
        return ~(s.good ^ s.x.bit(0))

    fault = translated.fault(broken, 0)
    claim = Claim(
        "f.f", model, strange, "said", REFUTED, "", "", any_of_faults([fault]), None, None, (), (), {}, 6, 1, "bits",
        None, None, None,
    )  # fmt: skip
    found = prove(claim, Limits(20, ("z3",)))
    shown = [_first_strange(model, broken, at, value) for at in range(5) for value in (False, True)]
    firsts = [step for step in shown if step is not None]
    assert found.verdict == REFUTED and found.steps == min(firsts) + 1


def _first_strange(model: type[Model], broken: Broken, at: int, value: bool) -> int | None:
    timing = {} if broken.onset == FROM_START else {"at": at}
    chosen = {"values": {"o": [value]}} if broken.kind == "byzantine" else {}
    faulted = instrument(trace(model), [translated.fault(broken, 0, **timing, **chosen)])
    start = {"fault0.o.last": value} if broken.kind == "frozen" else {}
    choose = schedule(faulted)
    found = run(faulted.system, lambda k: {"p": False, "q": False, **choose(k)}, 6, start=start)
    return next((k for k in range(6) if found["good"][k] != bool(found["x"][k] & 1)), None)


# --- onsets, budgets, names ----------------------------------------------------------------------------------------


def test_a_transient_fault_acts_once_and_not_too_long() -> None:
    faulted = instrument(trace(Line), [Fault(flip(), ["wire"], TRANSIENT, ticks=3)])
    for now in ("1111111", "0110110", "1010101", "0011111"):
        found = run(faulted.system, lambda k, now=now: {"w": False, "n": 0, now_name(0): now[k] == "1"}, 7)["wire"]
        acted = "".join(str(int(v)) for v in found)
        assert acted.strip("0") in ("111", "11", "1") and now.startswith(acted.rstrip("0"))


def test_acted_is_what_was_active_before() -> None:
    for onset, ticks in ((ANY_TIME, None), (TRANSIENT, 2), (INTERMITTENT, None)):
        faulted = instrument(trace(Line), [Fault(flip(), ["wire"], onset, ticks=ticks)], present=None)
        watched = {"active": faulted.active[0], "acted": faulted.acted[0]}
        system = replace(faulted.system, signals={**faulted.system.signals, **watched})
        found = run(system, lambda k: {"w": False, "n": 0, now_name(0): k in (2, 3, 5)}, 8, start={"fault0": True})
        assert found["acted"] == [any(found["active"][:k]) for k in range(8)] == [False] * 3 + [True] * 5
        gone = run(system, {"w": False, "n": 0, now_name(0): True}, 3)
        assert not any(gone["active"]) and not any(gone["acted"]) and gone["wire"] == [False] * 3


def test_a_budget_counts_those_that_are_there() -> None:
    some = [Fault(stuck(0), ["wire"]), Fault(stuck(1), ["wire"]), Fault(stuck(1), ["word"])]
    faulted = instrument(trace(Line), some, present=None)
    for most in range(4):
        condition = within(at_most(most, some), faulted)
        for present in range(8):
            chosen = {t: bool(present >> i & 1) for i, t in enumerate(faulted.present)}
            assert evaluate([condition], chosen)[0] == (present.bit_count() <= most)
    assert within(any_of_faults(some), faulted).is_const
    for wrong in (-1, True, 1.0):
        with pytest.raises(ModelError, match="a number of faults is 0 or more"):
            at_most(wrong, some)  # type: ignore[arg-type]


class Lines(Model, event="tick"):
    """Two lines."""

    first: Line
    second: Line

    def step(self, w: Bit, n: U4) -> Lines:
        return Lines(first=self.first.step(w, n)[0], second=self.second.step(w, n)[0])


def test_faults_are_expanded_by_part_pattern_and_list() -> None:
    system = trace(Lines)
    assert [(f.name, f.onset) for f in expand(system, "line")] == [("first", ANY_TIME), ("second", ANY_TIME)]
    assert [f.name for f in every(stuck(0), "*.wire")(system)] == ["first.wire stuck-at-0", "second.wire stuck-at-0"]
    assert [f.points for f in every(missing(), "first.*")(system)] == [["first.wire"]]
    assert len(expand(system, [Fault(flip(), ["first.wire"]), "line", [every(flip(), "*")]])) == 7
    assert str(Fault(flip(), "first.wire", ANY_TIME)) == "first.wire flip, any time"


def test_active_within_a_prefix_needs_all_points_there() -> None:
    some = [Fault(flip(), ["first.*"]), Fault(flip(), ["*.wire"])]
    faulted = instrument(trace(Lines), some, present=None)
    assert any_active(faulted, "first.") is faulted.active[0]
    assert describe(any_active(faulted)) == "(fault0 | fault1)"
    assert any_active(faulted, "second.") is bit(False)


def test_steps_taken_together_leave_each_its_own_choice() -> None:
    faulted = together(instrument(trace(Line), [Fault(byzantine(), ["wire"], ANY_TIME)], present=None), 3)
    base = ("fault0.now", "fault0.wire.value")
    names = [*base, *(f"{name} (step {k})" for k in (0, 1) for name in base)]
    assert sorted(faulted.system.inputs) == sorted(["w", "n", *names])
    assert sorted(faulted.choices) == sorted(names)
    with pytest.raises(ModelError, match="several steps taken as one; build its fault in before"):
        instrument(repeat(trace(Stages), 2), [Fault(frozen(), ["x"])])


class Stages(Model, event="tick"):
    """A register behind a point."""

    x: U2 = power_up(0)

    def step(self) -> Stages:
        return Stages(x=point("x", (self.x + 1).low(2)))


class Mixed(Model, event="tick"):
    """A point of each other sort."""

    r: Real = power_up(0)

    def step(self, i: Bit) -> tuple[Mixed, Int]:
        return Mixed(r=point("real", self.r + 1)), point("whole", i.word().int() - 3)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Fault(flip(), ["wire"], "sometimes"), "fault onset 'sometimes'; it is one of: from start, any time"),
        (lambda: Fault(flip(), ["wire"], TRANSIENT), "a transient fault needs its greatest length"),
        (lambda: Fault(flip(), ["wire"], TRANSIENT, ticks=0), "needs its greatest length"),
        (lambda: Fault(flip(), ["wire"], TRANSIENT, at=-1, ticks=1), "at=-1 is before power-up"),
        (lambda: Fault(flip(), ["wire"], ANY_TIME, at=-3), "at=-3 is before power-up"),
        (lambda: Fault(flip(), ["wire"], INTERMITTENT, ticks=0), "intermittent fault with ticks=0 never acts"),
        (lambda: Fault(flip(), ["wire"], INTERMITTENT, at=1, ticks=-5), "with ticks=-5 never acts"),
        (lambda: Fault(flip(), ["wire"], at=5), "at=5 is not there from the start: write onset=ANY_TIME"),
        (lambda: Fault(flip(), ["wire"], ticks=5), "stays for ever; ticks=5"),
        (lambda: Fault(flip(), ["wire"], ANY_TIME, ticks=5), "any time stays for ever"),
        (lambda: stuck(2), "a wire is stuck at 0 or at 1"),
        (lambda: delayed(0), "a delay is 1 step or more"),
        (lambda: missing(0), "at least 1 pulse is lost"),
        (lambda: instrument(trace(Line), [Fault(flip(bit=4), ["word"])]), "u4 has bits 0..3, not bit 4"),
        (lambda: instrument(trace(Line), [Fault(flip(), ["wrie"])]), "Line has no point 'wrie'; did you mean wire"),
        (lambda: instrument(trace(Line), [Fault(missing(), ["word"])]), "does not apply to word, a u4"),
        (lambda: instrument(trace(Mixed), [Fault(flip(), ["whole"])]), r"does not apply to whole, a int\[-3, 1\]"),
        (lambda: expand(trace(Lines), "channel"), "no part of kind 'channel'; there is line"),
        (
            lambda: schedule(instrument(trace(Line), [Fault(flip(), ["wire"], values={"wire": [True]})])),
            "has values for 'wire', where it chooses none",
        ),
        (
            lambda: run(instrument(trace(Line), [Fault(byzantine(), ["word"])]).system, {"w": True, "n": 1}, 1),
            "lacks the input fault0",
        ),
    ],
)
def test_misuse_is_told(make: Any, says: str) -> None:
    with pytest.raises(ModelError, match=says):
        make()


def test_every_sort_can_be_byzantine_frozen_or_late() -> None:
    for kind in (byzantine(), frozen(), delayed(1)):
        for at in ("real", "whole"):
            faulted = instrument(trace(Mixed), [Fault(kind, [at])])
            choose = schedule(faulted)
            usual = {n: -3 if n.endswith("whole.value") else v for n, v in choose(0).items()}
            assert len(run(faulted.system, {"i": True, **usual}, 3)) == 3
