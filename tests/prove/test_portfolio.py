"""Engines that sleep, eat, crash, lie or are interrupted harm nobody but themselves, and leave nothing behind."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from safety.faults import any_of_faults, every, flip
from safety.prove.claims import BOUNDED, PROVED, REFUTED, Scenario, Seen
from safety.prove.engines.engine import NAMES, Engine, Result
from safety.prove.engines.portfolio import Interrupted, portfolio
from safety.prove.engines.transport import packed, portable, unpacked
from safety.prove.problem import Problem, build_problem
from safety.prove.solve import UNKNOWN, Disagreement
from safety.system import ANY, ModelError
from safety.terms import Bit, bit, real
from safety.terms.graph import BIT, variable, variables
from tests.prove.planted_engines import (
    bounds,
    chatters,
    checks,
    crashes,
    eats_memory,
    exits,
    finds_a_difference,
    planted,
    proves,
    raises,
    sleeps,
    spins,
    starts_a_tool,
)
from tests.prove.small import asked, passed_in_time

posix = pytest.mark.skipif(os.name != "posix", reason="caps and process groups are those of POSIX")


def never_high(s: Seen) -> Bit:
    """False after nine steps."""
    return ~s.high


def problem(formula: Callable[[Seen], Bit] = never_high, **changes: Any) -> Problem:
    return build_problem(asked(formula, **changes))


def alive(pid: int) -> bool:
    """Whether a process still does anything: an orphan that has ended may wait for long to be collected."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    state = Path(f"/proc/{pid}/stat")
    return not (state.exists() and state.read_text().rpartition(")")[2].split()[0] == "Z")


def gone(*pids: int) -> bool:
    """Whether the processes have ended, or do within a few seconds."""
    for _ in range(100):
        if not any(map(alive, pids)):
            return True
        time.sleep(0.1)
    return False


@pytest.fixture(autouse=True)
def nothing_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """After each test there is neither a child that was not there before, dead or alive, nor a file."""
    before = children()
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(scratch))
    yield
    assert list(scratch.iterdir()) == []
    assert children() <= before


def children() -> set[str]:
    """The processes that this one has started and not yet waited for, where the system tells."""
    return {child for file in Path("/proc/self/task").glob("*/children") for child in file.read_text().split()}


def only(*runs: Any, **options: Any) -> list[Result]:
    return portfolio(problem(), [one if isinstance(one, str) else planted(one) for one in runs], **options)


# --- answers -------------------------------------------------------------------------------------------------------


def test_the_first_conclusive_answer_ends_the_others() -> None:
    told: list[str] = []
    slow, quick, waiting = only(sleeps, "bounded", bounds, progress=told.append)
    assert (quick.verdict, quick.steps) == (REFUTED, 9)
    assert quick.trace is not None and quick.trace["claim.holds"] == [True] * 8 + [False]
    assert slow.why == "ended: another engine had answered"
    assert (waiting.verdict, waiting.why) == (UNKNOWN, "not started: another engine had answered")
    assert "bounded: refuted, 9 steps" in told


def test_terms_and_runs_come_home() -> None:
    asked_of = problem(passed_in_time)
    (found,) = portfolio(asked_of, ["spacer"])
    assert found.invariant is not None and found.agreed_by == ("z3", "cvc5", "spacer")
    (lemma,) = found.invariant.values()
    assert {v.uid for v in variables([lemma])} == {s.var.uid for s in asked_of.system.states}
    (refuted,) = portfolio(problem(), ["bounded"])
    assert refuted.trace is not None and refuted.trace.system.state["n"].var is problem().system.state["n"].var


def test_every_engine_at_once() -> None:
    found = portfolio(problem(), seconds=20, every_answer=True)
    assert [r.engine for r in found] == list(NAMES)
    assert {r.verdict for r in found} <= {REFUTED, UNKNOWN}
    assert {r.engine: r.verdict for r in found}["bounded"] == REFUTED


def test_a_problem_that_an_engine_cannot_take_is_named() -> None:
    (found,) = portfolio(problem(lambda s: s.n.real() + real("1/2") > 0), ["pdr"])
    assert found.verdict == UNKNOWN and ("is a real: it has no bits" in found.why or "not on the path" in found.why)


def test_an_engine_that_cannot_run_says_why() -> None:
    missing = Engine("missing", _missing, proves)
    (found,) = portfolio(problem(), [missing])
    assert (found.verdict, found.why) == (UNKNOWN, "no such tool")


def _missing() -> str:
    return "no such tool"


@pytest.mark.parametrize("options", [{"seconds": 0}, {"memory_mb": 0}, {"workers": 0}])
def test_a_portfolio_needs_something(options: dict[str, Any]) -> None:
    with pytest.raises(ModelError, match="needs more than 0 of each"):
        only(sleeps, **options)


# --- answers that cannot both be right -----------------------------------------------------------------------------


def test_a_false_proof_beside_a_replayed_run_is_a_disagreement() -> None:
    with pytest.raises(Disagreement, match="proves says proved, bounded has a run of 9 steps that breaks it"):
        only(proves, "bounded", every_answer=True)


def test_a_false_bound_beside_a_replayed_run_is_a_disagreement() -> None:
    with pytest.raises(Disagreement, match="bounds says bounded, bounded has a run of 9 steps"):
        only("bounded", bounds, every_answer=True, workers=1)


def test_what_contradicts_what() -> None:
    (refuted,) = only("bounded")
    proved, short, long = Result("p", PROVED), Result("s", BOUNDED, steps=8), Result("l", BOUNDED, steps=9)
    for one, other, both in (refuted, proved, True), (refuted, long, True), (refuted, short, False):
        assert one.contradicts(other) is other.contradicts(one) is both
    assert not any(proved.contradicts(other) for other in (proved, short, long, Result("u")))
    assert not refuted.contradicts(refuted)


def test_a_disagreement_within_an_engine_ends_all() -> None:
    with pytest.raises(Disagreement, match="two readings differ"):
        only(sleeps, finds_a_difference)


# --- engines that break down ---------------------------------------------------------------------------------------


@posix
def test_what_has_not_ended_in_time_is_ended_with_all_that_it_has_started_and_keeps_what_it_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    notes = tmp_path / "pids"
    monkeypatch.setenv("PLANTED_PIDS", str(notes))
    slow, checking, busy, well = only(starts_a_tool, checks, spins, chatters, seconds=4, workers=4, every_answer=True)
    assert (slow.verdict, slow.steps, slow.why) == (BOUNDED, 3, "ended: no answer within 4 s")
    assert gone(*map(int, notes.read_text().split()))
    assert (checking.verdict, checking.agreed_by) == (PROVED, ("checks",))  # it has ended nobody by its own
    assert checking.why == "rests on checks alone; ended: no answer within 4 s"
    assert (busy.verdict, busy.why) == (UNKNOWN, "ended: no answer within 4 s")
    assert (well.verdict, well.steps, well.why) == (BOUNDED, 1, "")


@posix
def test_an_engine_that_eats_memory_is_stopped() -> None:
    greedy, well = only(eats_memory, chatters, memory_mb=1500, seconds=30)
    assert (greedy.verdict, greedy.why) == (UNKNOWN, "it ran out of memory")
    assert well.verdict == BOUNDED


@posix
@pytest.mark.parametrize(
    ("run", "why"),
    [
        (exits, "it ended without an answer (exit code 7)"),
        (crashes, f"it crashed (signal {signal.SIGSEGV.value}): the last words"),
        (raises, "it failed: ValueError: no such luck"),
    ],
)
def test_an_engine_that_dies_takes_nobody_with_it(run: Any, why: str) -> None:
    dead, well = only(run, chatters)
    assert (dead.verdict, dead.why) == (UNKNOWN, why)
    assert (well.verdict, well.why) == (BOUNDED, "")


# --- the end from outside ------------------------------------------------------------------------------------------


def test_an_interrupt_keeps_what_there_is() -> None:
    def interrupt(told: str) -> None:
        if told.startswith("chatters"):
            raise KeyboardInterrupt

    with pytest.raises(Interrupted) as stopped:
        only(sleeps, chatters, progress=interrupt)
    slow, well = stopped.value.results
    assert (well.verdict, slow.why) == (BOUNDED, "interrupted")


SCRIPT = """
import sys
from safety.prove.engines.portfolio import portfolio
from tests.prove.planted_engines import planted, spins, starts_a_tool
from tests.prove.test_portfolio import problem
try:
    portfolio(problem(), [planted(starts_a_tool), planted(spins)], seconds=60)
except KeyboardInterrupt:
    sys.exit(130)
"""


@posix
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGKILL, -signal.SIGKILL)])
def test_engines_end_with_their_parent(number: int, code: int, tmp_path: Path) -> None:
    notes, scratch = tmp_path / "pids", tmp_path / "own"
    scratch.mkdir()
    env = {**os.environ, "PLANTED_PIDS": str(notes), "PYTHONPATH": os.pathsep.join(sys.path), "TMPDIR": str(scratch)}
    parent = subprocess.Popen([sys.executable, "-c", SCRIPT], env=env)
    for _ in range(300):
        if notes.exists() or parent.poll() is not None:
            break
        time.sleep(0.1)
    parent.send_signal(number)
    assert parent.wait(30) == code
    assert gone(*map(int, notes.read_text().split()))
    assert number == signal.SIGKILL or list(scratch.iterdir()) == []


# --- what travels --------------------------------------------------------------------------------------------------


def test_a_claim_of_functions_travels_without_them() -> None:
    whole = problem(
        lambda s: ~s.high | s.on, lemmas=[passed_in_time], faults=any_of_faults(every(flip(), "n")),
        scenario=Scenario(2, {"go": lambda k: k > 0}), start=lambda s: s.n < 3, given=lambda s: ~s.high,
    )  # fmt: skip
    with pytest.raises((pickle.PicklingError, AttributeError, TypeError)):
        pickle.dumps(whole)
    sent = portable(whole)
    back: Problem = unpacked(packed(sent))
    assert back.holds is whole.holds and back.given is whole.given and back.start is whole.start
    assert back.lemmas == whole.lemmas and back.system.states == whole.system.states
    assert [s.power_up for s in back.system.states] == [s.power_up for s in whole.system.states]
    assert back.claim.id == whole.claim.id and back.claim.steps == whole.claim.steps
    with pytest.raises(AssertionError, match="stand-in"):
        back.claim.formula(None)  # type: ignore[arg-type]


def test_the_power_up_value_that_may_be_anything_stays_the_one() -> None:
    open_ = problem(anywhere=True)
    back: Problem = unpacked(packed(portable(open_)))
    assert all(s.power_up is ANY for s in back.system.states)
    (found,) = portfolio(open_, ["bounded"])
    assert (found.verdict, found.steps) == (REFUTED, 1)


def test_a_deep_term_travels() -> None:
    deep: Bit = bit(False)
    for n in range(20_000):
        deep = variable(f"w{n}", BIT) ^ deep  # type: ignore[assignment, operator]
    assert unpacked(packed({"deep": deep})) == {"deep": deep}
