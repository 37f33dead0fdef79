"""Every verdict on random small equipment is what visiting all its states says: no proof of a falsehood, no miss.

The other side (`tests.prove.naive`) is plain Python on tuples: it shares neither terms nor solvers with the toolkit.
"""

from __future__ import annotations

import random
from collections import Counter
from typing import Any

import pytest

from safety.prove.claims import BITS, BOUNDED, INTEGERS, PROVED, REFUTED, UNDECIDED, VACUOUS
from safety.prove.prove import Limits, Outcome, prove
from safety.system import ModelError
from tests.prove import chance, naive, translated
from tests.prove.naive import Machine, TooLarge, Truth, value

STEPS = 5
BLOCK = 200
NONE = {"synthesis": 0.0, "simulation": 0.0, "portfolio": 0.0}


def drawn(seed: int, **means: float) -> tuple[Machine, Outcome] | None:
    """A random machine with the toolkit's outcome; None where there is no claim in it, or too many states.

    By induction and bounded search, and by what `means` allows.
    """
    rng = random.Random(seed)
    machine = Machine(chance.equipment(rng), chance.question(rng))
    claim = translated.claim(
        machine.asked,
        translated.model(machine.made),
        expect=rng.choice([PROVED, PROVED, REFUTED]),
        steps=STEPS,
        induction=rng.choice([0, 1, 2, 4]),
        arithmetic=rng.choice([INTEGERS, BITS]),
    )
    solvers = ("z3", "cvc5") if seed % 5 == 0 else ("z3",)
    try:
        return machine, prove(claim, Limits(20, solvers, **(NONE | means)))
    except ModelError as error:
        assert "names no signal" in str(error)
        return None


def wrong(found: Outcome, truth: Truth) -> str:
    """What is wrong with a verdict; nothing where it is right."""
    within = [step is not None and step < STEPS for step in truth.met]
    broken_within = truth.broken is not None and truth.broken < STEPS
    match found.verdict:
        case "refuted" if truth.broken is None:
            return "there is no such violation"
        case "refuted" if found.steps != truth.broken + 1:
            return f"the shortest run has {truth.broken + 1} steps"
        case "proved" if truth.broken is not None:
            return f"it breaks at step {truth.broken}"
        case "bounded" if broken_within:
            return f"it breaks at step {truth.broken}"
        case "proved" | "bounded" if None in truth.met:
            return "a premise cannot happen"
        case "bounded" if not all(within):
            return "a premise was not shown within the bound"
        case "proved" | "bounded" if all(within) and found.premise_at != max(step or 0 for step in truth.met):
            return f"the premises are met at {truth.met}"
        case "vacuous" if all(step is not None for step in truth.met):
            return "every premise can happen"
        case "vacuous" | "undecided" if broken_within:
            return f"it breaks at step {truth.broken}"
        case "undecided" if all(within):
            return "every premise can happen within the bound"
    return ""


def is_real(machine: Machine, found: Outcome) -> bool:
    """Whether the counterexample is a run of the naive machine that breaks the claim at its last step only."""
    trace, problem = found.counterexample, found.problem
    assert trace is not None and problem is not None

    def at(path: str, step: int, usual: Any = False) -> Any:
        return trace.columns[path][step] if path in trace.columns else usual

    present = tuple(at(f"fault{i}", 0) for i in range(len(machine.asked.faults)))
    memory = [trace.chosen.get(f"fault{i}.{place}.last") for i, place in machine.seats]
    fitting = [
        s
        for s in machine.starts()
        if (s[0], s[1], s[2]) == (at("x", 0), at("y", 0), present)
        and all(m is None or m == k for m, k in zip(memory, s[4], strict=True))
    ]
    assert len(fitting) == 1
    (state,) = fitting
    for step in range(len(trace)):
        chosen: dict[Any, Any] = {"p": at("p", step), "q": at("q", step)}
        chosen |= {("now", i): at(f"fault{i}.now", step) for i in range(len(machine.asked.faults))}
        chosen |= {("value", i, place): at(f"fault{i}.{place}.value", step) for i, place in machine.seats}
        env, state = machine.step(state, chosen)
        assert {n: env[n] for n in ("x", "y", "a", "w", "good", "level")} == {
            n: trace[n][step] for n in ("x", "y", "a", "w", "good", "level")
        }
        assert machine.allowed(env)
        if value(machine.asked.holds, env) != (step < len(trace) - 1):
            return False
    return True


def verdicts(seeds: range, **means: float) -> Counter[str]:
    told: Counter[str] = Counter()
    for seed in seeds:
        made = drawn(seed, **means)
        if made is None:
            continue
        machine, found = made
        try:
            truth = naive.truth(machine)
        except TooLarge:
            continue
        assert not (said := wrong(found, truth)), f"seed {seed}: {found.verdict} {found.steps}: {said}"
        if found.verdict == REFUTED:
            assert is_real(machine, found), f"seed {seed}"
        told[found.verdict] += 1
    return told


@pytest.mark.parametrize("block", range(4))
def test_no_wrong_verdict(block: int) -> None:
    told = verdicts(range(block * BLOCK, (block + 1) * BLOCK))
    assert told.total() > BLOCK * 0.8 and min(told[PROVED], told[BOUNDED], told[VACUOUS], told[REFUTED]) > 10


def test_all_verdicts_are_met() -> None:
    assert set(verdicts(range(10_000, 10_100))) == {PROVED, BOUNDED, REFUTED, VACUOUS, UNDECIDED}


def test_no_wrong_verdict_by_other_means() -> None:
    """Lemmas that are found and simulation leave less open, and nothing that they say is wrong."""
    seeds = range(11_000, 11_040)
    less, more = verdicts(seeds), verdicts(seeds, synthesis=2.0, simulation=0.2)
    assert more[BOUNDED] < less[BOUNDED] and more[PROVED] > less[PROVED]


@pytest.mark.slow
def test_no_wrong_verdict_by_any_means() -> None:
    verdicts(range(12_000, 12_100), synthesis=5.0, simulation=1.0, portfolio=5.0)


@pytest.mark.slow
@pytest.mark.parametrize("block", range(40))
def test_no_wrong_verdict_among_thousands(block: int) -> None:
    verdicts(range(100_000 + block * BLOCK, 100_000 + (block + 1) * BLOCK))
