"""A claim's outcome out of the cache, found by the problem that the claim poses, or worked out and kept.

What was found for a problem holds for the same problem, whatever its claim is called: the entry is made anew from the
claim as it stands now.  A refutation is replayed before it counts.  A bounded verdict is kept for the time limit it was
found with and shorter ones; what is undecided, or not confirmed by every solver, is asked anew each time.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from safety.prove.cache import Cache, prover
from safety.report.schema import Entry

if TYPE_CHECKING:
    from safety.prove.problem import Problem, Progress
    from safety.prove.prove import Limits, Outcome
    from safety.trace import Trace

FOLDER = ".rightside/cache"
SCRIPTED, SEARCHED = "scripted scenario", "bounded search, replayed"  # methods
_NOT_KEPT = {"claim", "problem", "counterexample"}
started_with = functools.cache(prover)  # what this process loaded; a worker asks first of all


class Recalled(NamedTuple):
    """An outcome, whether it is an earlier one, and the earlier one where both are there to be compared."""

    outcome: Outcome
    cached: bool = False
    before: Outcome | None = None

    @property
    def differs(self) -> bool:
        """Whether the two say different things; that one of them was left undecided is no difference.

        Nor are two runs, unless both are the smallest one there is.
        """
        before, now = self.before, self.outcome
        if before is None or now.verdict == "undecided":
            return False
        smallest = before.method == now.method == SEARCHED
        runs = [each.counterexample.columns if smallest and each.counterexample else None for each in (before, now)]
        return before.verdict != now.verdict or runs[0] != runs[1]

    @property
    def marks(self) -> Entry:
        """What the entry says about it."""
        if self.before is None:
            return {"cached": True} if self.cached else {}
        was = f"{self.before.verdict}{f' in {self.before.steps} steps' if self.before.steps else ''}"
        if self.differs:
            return {"disagreed_by": [f"the cache ({was})"]}
        if self.outcome.verdict == "undecided":
            return {"why": f"{self.outcome.why}; the cache says {was}"}
        return {"rechecked": True}


def folder(root: Path) -> Path:
    """Where a project's cache lies."""
    return root / FOLDER


def key_of(problem: Problem, limits: Limits) -> str | None:
    """The key of a problem; None when it has none."""
    from safety.canonical import NoKeyError
    from safety.prove.canonical import problem_key

    others = {name: value for name, value in vars(limits).items() if name != "timeout"}
    try:
        return problem_key(problem, started_with(), repr(sorted(others.items())))
    except NoKeyError:
        return None


def recalled(
    cache: Cache | None, problem: Problem, limits: Limits, again: bool = False, say: Progress | None = None
) -> Recalled:
    """The outcome for a problem; `again`: worked out in any case, and compared with an earlier one.

    `say` is told what is being tried.
    """
    from safety.prove.prove import decide

    if cache is None:
        return Recalled(decide(problem, limits, say))
    key = key_of(problem, limits)
    before = _restored(cache, problem, cache.get(key), limits) if key else None
    if before is not None and not again:
        return Recalled(before, cached=True)
    found = Recalled(decide(problem, limits, say), before=before)
    record = _record(found.outcome, problem, limits)
    if key and found.differs:  # neither can be relied on
        cache.drop(key)
    elif key and record and prover() == started_with():
        cache.put(key, record)
    return found


def usable(record: Any, timeout: float) -> bool:
    """Whether a record still says all that could be found out within the time limit."""
    return bool(record) and (record["settled"] or timeout <= record["timeout"])


def _record(outcome: Outcome, problem: Problem, limits: Limits) -> dict[str, Any] | None:
    """An outcome as plain data; None when it is not to be kept."""
    from safety.canonical import written
    from safety.prove.stimulus import stimulus

    fields = {f.name: getattr(outcome, f.name) for f in dataclasses.fields(outcome) if f.name not in _NOT_KEPT}
    trace, scripted = outcome.counterexample, outcome.method.startswith(SCRIPTED)
    confirmed = len(outcome.agreed_by) >= len(limits.solvers) and outcome.verdict in ("proved", "vacuous")
    settled = trace is not None or confirmed
    proved = outcome.problem or problem  # perhaps with lemmas that were found
    changed = [f.name for f in dataclasses.fields(problem) if getattr(proved, f.name) is not getattr(problem, f.name)]
    if (not settled and outcome.verdict != "bounded") or changed not in ([], ["lemmas"]):
        return None
    try:
        told = {name: _plain(value) for name, value in fields.items()}
    except TypeError:  # of a kind that this does not know
        return None
    return {
        "outcome": told,
        "lemmas": written(proved.lemmas) if changed else None,
        "stimulus": stimulus(trace) if trace is not None and not scripted else None,
        "timeout": limits.timeout,
        "settled": settled,
    }


def _plain(value: Any) -> Any:
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, Fraction):
        return str(value)
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    raise TypeError(f"{value!r} is no plain data")


def _restored(cache: Cache, problem: Problem, record: Any, limits: Limits) -> Outcome | None:
    """The outcome that a record holds, its counterexample run again; None when it is not to be used."""
    from safety.canonical import read
    from safety.prove.prove import Outcome

    if not usable(record, limits.timeout):
        return None
    try:
        proved = dataclasses.replace(problem, lemmas=read(record["lemmas"])) if record["lemmas"] else problem
    except ValueError as error:
        cache.warn(f"cache: the lemmas kept for {problem.claim.id} cannot be read ({error}); it is worked out anew")
        return None
    told: dict[str, Any] = record["outcome"]
    told |= {name: tuple(told[name]) for name in _tuples(Outcome) & told.keys()}
    outcome = Outcome(problem.claim, problem=proved, **told)
    if outcome.verdict != "refuted":
        return outcome
    outcome.counterexample = _run_again(problem, record["stimulus"], outcome.steps or 0)
    if outcome.counterexample is None:
        cache.warn(f"cache: the run kept for {problem.claim.id} does not break it; it is worked out anew")
        return None
    return outcome


def _tuples(cls: type[Any]) -> set[str]:
    return {f.name for f in dataclasses.fields(cls) if str(f.type).startswith("tuple")}


def _run_again(problem: Problem, given: Any, steps: int) -> Trace | None:
    """The run of a refutation, if it breaks the claim at its last step and keeps its assumptions."""
    from safety.prove import search
    from safety.prove.problem import observed
    from safety.prove.stimulus import rerun
    from safety.system import ModelError

    try:
        if given is None:
            script = problem.claim.scenario
            return search.cut_at(search.scripted(problem, script), "claim.holds", False) if script else None
        trace = rerun(observed(problem), given, steps)
    except (ModelError, KeyError):
        return None
    broken = trace["claim.holds"].index(False) if False in trace["claim.holds"] else -1
    return trace if broken == steps - 1 and all(trace["claim.given"]) else None
