"""Claims about windows, isolation and how far apart limits may lie: verdicts, planted bugs, a naive count of frames."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest

from models.ts7 import voting
from models.ts7.voting import Trio
from proofs import ts7_isolation, ts7_synchronisation
from proofs.ts7_brake_chain import RELEASE, WORDS
from proofs.ts7_isolation import T_SYNC_OF, WITHIN_ONE_WORD, Following
from safety import REFUTED, ModelError
from safety.prove.claims import Claim, claim_id, registered
from safety.prove.induction import by_induction
from safety.prove.problem import build_problem
from safety.prove.prove import prove
from safety.prove.search import scripted

CLAIMS = {c.id: c for c in registered() if c.id.startswith(("ts7_synchronisation.", "ts7_isolation."))}


@pytest.mark.parametrize("name", CLAIMS)
def test_verdict(name: str) -> None:
    found = prove(CLAIMS[name])
    assert found.as_expected, found.why
    assert found.verdict == REFUTED or found.agreed_by == ["z3", "cvc5"]


def of(formula: object) -> Claim:
    return CLAIMS[claim_id(formula)]  # type: ignore[arg-type]


def only_the_braking(commands: Trio) -> Trio:
    """Planted: a channel that brakes alone is isolated, a silent one is not."""
    a, b, c = commands
    return Trio(a & ~b & ~c, b & ~a & ~c, c & ~a & ~b)


def test_silence_that_nobody_isolates_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(voting, "outvoted", only_the_braking)
    claim = of(ts7_synchronisation.silence_ends_in_isolation)
    assert prove(replace(claim, scenario=claim.witness)).verdict == REFUTED
    assert prove(of(ts7_synchronisation.a_lone_brake_is_isolated)).as_expected


def test_isolation_of_the_majority_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    right = voting.outvoted
    monkeypatch.setattr(voting, "outvoted", lambda seen: Trio(*(~odd for odd in right(seen))))
    claim = of(ts7_synchronisation.synchronisation_isolates_at_most_one)
    assert not by_induction(build_problem(claim), 1, True, 20, ("z3",)).proved


@pytest.mark.parametrize("setting", [{"lowering": 3}, {"lowering": 2}])
def test_less_lowering_is_not_enough(setting: dict[str, int]) -> None:
    """With less lowering the proof for limits 1 word apart must not go through."""
    less = {f"{n}.{name}": value for n in "abc" for name, value in setting.items()}
    claim = replace(of(WITHIN_ONE_WORD["s65"]), settings=less)
    assert not by_induction(build_problem(claim), 1, True, 20, ("z3",)).proved


def test_more_lowering_brakes_without_need() -> None:
    claim = of(ts7_synchronisation.no_brake_eight_words_below)
    more = replace(claim, settings={f"{n}.lowering": 5 for n in "abc"})
    assert not by_induction(build_problem(more), 1, True, 20, ("z3",)).proved


def frames_to_brake(limit: int, speed: int, wheel: int, phases: tuple[int, int, int, int]) -> int:
    """Naive: frames until the comparator of a free channel, u = 0, reaches 3; speed in 1/4096 word."""
    axle, j1, j0, divider = phases
    u = frames = 0
    while u < 3:
        frames += 1
        axle += speed
        j1 += wheel if axle >= 65536 * wheel else 0
        axle -= 65536 * wheel if axle >= 65536 * wheel else 0
        j0 += limit
        divider += j0 >> 8
        rise, fall = j1 > 255, divider > 15
        j0, j1, divider = j0 & 255, j1 & 255, divider & 15
        u = max(u + 1, 0) if rise and not fall else max(u - 1, 0) if fall and not rise else u
    return frames


def test_the_phases_that_isolate_at_two_words_are_too_slow() -> None:
    """Signal 75, own limit 163 lowered to 159, speed just above 161: the third pulse comes too late for T_sync."""
    assert frames_to_brake(159, 161 * 4096 + 1, 172, (374_807, 116, 220, 0)) == 3914 > 4000 - RELEASE - 1


@pytest.mark.parametrize("line", T_SYNC_OF)
def test_three_words_above_the_limit_brake_in_time(line: str) -> None:
    """Random phases, every wheel, every offset: never later than the bound that the proof rests on."""
    rng, word = random.Random(10), WORDS[line]
    worst = 0
    for _ in range(60):
        limit, wheel = rng.randint(word - 8, word), rng.randrange(156, 173, 2)
        phases = rng.randrange(65536 * wheel), rng.randrange(256), rng.randrange(256), rng.randrange(16)
        worst = max(worst, frames_to_brake(limit, (limit + 3) * 4096 + 1, wheel, phases))
    assert 2000 < worst <= Following(word).latched


def test_least_t_sync() -> None:
    assert T_SYNC_OF == {"s25": 4020, "s45": 4000, "s65": 4000, "s75": 4000, "s90": 4000}


def test_an_ordinary_release_isolates_a_healthy_channel() -> None:
    run = prove(of(ts7_isolation.nobody_isolated_by_an_ordinary_release)).counterexample
    assert run is not None
    assert [n for n in "abc" if run[f"targets.{n}"][-1]] == ["c"]
    last = {n: max(k for k, braking in enumerate(run[f"brakes.{n}"]) if braking) for n in "abc"}
    assert last["c"] == min(last.values()) < last["b"] < 6400, "the first to release, all long released"
    assert not any(run[f"{n}.fault"][-1] for n in "abc")
    assert {run[f"{n}.limit"][0] for n in "abc"} == {138}


def test_windows_do_open_within_one_word_and_all_follow() -> None:
    """Not about nothing: limits 1 word apart, a window opens, the lowered ones brake, nobody is isolated."""
    claim, twin = of(WITHIN_ONE_WORD["s75"]), of(ts7_isolation.nobody_isolated_within_two_words)
    assert twin.scenario is not None
    near = {**twin.scenario.start, "a.offset": 3}
    speed = {**twin.scenario.inputs, "speed": 162 * 4096 + 1}
    run = scripted(build_problem(claim), replace(twin.scenario, start=near, inputs=speed))
    assert any(run["synchronising"]) and all(any(run[f"brakes.{n}"]) for n in "abc")
    assert not any(run[f"targets.{n}"][-1] for n in "abc")


def test_a_scenario_outside_the_start_is_refused() -> None:
    claim = of(ts7_synchronisation.no_brake_seven_words_below)
    assert claim.scenario is not None
    outside = replace(claim.scenario, start={**claim.scenario.start, "b.ring.j1": 250})
    with pytest.raises(ModelError, match="breaks an assumption of the claim at step 0"):
        scripted(build_problem(claim), outside)


def test_unequal_relays_isolate_the_channel_that_is_up_first() -> None:
    claim = of(ts7_isolation.nobody_isolated_at_power_up_with_unequal_relays)
    run = prove(claim).counterexample
    assert run is not None and [n for n in "abc" if run[f"targets.{n}"][-1]] == ["a"]
    assert not any(run[f"{n}.fault"][-1] for n in "abc")
    assert claim.scenario is not None
    assert True not in scripted(build_problem(replace(claim, settings={})), claim.scenario)["targets.a"]


@pytest.mark.parametrize("name", "abc")
def test_the_lone_brake_of_each_channel_is_isolated(name: str) -> None:
    lone = {n: [(1000, 30_000)] if n == name else [] for n in "abc"}
    claim = of(ts7_synchronisation.a_lone_brake_is_isolated)
    run = scripted(build_problem(claim), ts7_synchronisation.demands(6000, **lone))
    assert [n for n in "abc" if run[f"targets.{n}"][-1]] == [name]
