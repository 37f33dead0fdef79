"""The range in which nobody is isolated: as found, against the formula of the docstring, and planted bugs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import pytest

from models.ts7.numbers import KMH_PER_WORD, WORD
from models.ts7.train import SCALE
from proofs import ts7_synthesis
from proofs.ts7_brake_chain import RELEASE, WORDS
from proofs.ts7_synthesis import LATE, Following, asked, late, least_window
from safety import PROVED
from safety.prove import search
from safety.prove import weakest as weak
from safety.prove.outcome import Limits
from safety.prove.prove import prove, stated
from safety.prove.weakest import Synthesis
from safety.prove.weakest_search import find

LIMITS = Limits(synthesis=0, simulation=0, portfolio=0)
LEAST_WINDOW = {"s25": (3079, 3730), "s45": (2804, 3630), "s65": (2828, 3613), "s75": (2877, 3614), "s90": (2998, 3621)}


def of(name: str) -> Synthesis:
    return next(s for s in weak.declared() if s.id == f"ts7_synthesis.{name}")


def naive_follower(line: str, spare: int) -> int:
    """Steps until b brakes in the run of `late`, by an account of pulses: no ring, no comparator, no relay."""
    wheel, j1, axle, reference = LATE[line][spare]
    limit, speed = WORDS[line] - 4, 4096 * (WORDS[line] - 4) + 1
    step, ahead = 0, 0
    while ahead < 3:
        pulses = -1  # of the reference at this step
        reference += limit + (4 - spare if step == 0 else -spare)
        pulses = reference // 4096
        reference %= 4096
        axle += speed
        corrected = j1 + wheel * (axle // (SCALE * wheel))
        axle %= SCALE * wheel
        ahead = max(0, ahead + corrected // 256 - pulses)
        j1 = corrected % 256
        step += 1
    return step


@pytest.mark.parametrize(("line", "spare"), [(line, spare) for line in LATE for spare in (2, 3)])
def test_the_run_breaks_it_up_to_the_window_that_the_pulses_give(line: str, spare: int) -> None:
    last = naive_follower(line, spare) - 1 + RELEASE - 1  # relay b still closed at the end of this window
    for frames, broken in ((last, True), (last + 1, False)):
        problem = stated(replace(asked(line, "x", 4 - spare, frames=frames)))
        run = search.scripted(problem, replace(late(line, 4 - spare), start={**late(line, 4 - spare).start,
                              "common.sync.frames": frames}), ["claim.holds", "claim.given"])  # fmt: skip
        assert (False in run["claim.holds"]) == broken
    if spare == 3:
        assert last == LEAST_WINDOW[line][0]


@pytest.mark.parametrize("line", LATE)
def test_the_least_window_follows_from_the_formula(line: str) -> None:
    beats = (2 + 100 / 256) * 4096 / 3
    pulses = 4096 / (WORDS[line] - 12) + 3 * 172 / 256 * 4096 / (WORDS[line] - 4)
    quantised = 2 * (WORDS[line] + 1) / 3
    assert LEAST_WINDOW[line][1] == pytest.approx(beats + pulses + quantised + RELEASE, abs=4)
    assert Following(WORDS[line], 3).latched + RELEASE == LEAST_WINDOW[line][1]


@pytest.mark.slow
def test_least_window_at_one_signal() -> None:
    found = find(of("least_window_at_s65"), LIMITS)
    assert (found.refuted_at, found.safe_from) == LEAST_WINDOW["s65"]
    assert found.settled
    assert not found.exact
    assert found.proof.agreed_by == ["z3", "cvc5"]


def test_greatest_spread_at_one_signal_is_exact() -> None:
    found = find(of("greatest_spread_at_s25"), LIMITS)
    assert (found.safe_from, found.refuted_at, found.exact) == (1, 2, True)


@pytest.mark.parametrize(
    "change",
    [{"frames": 3612}, {"release": RELEASE + 1, "frames": 3613}, {"spread": 2, "frames": 3613}, {"lowering": 3}],
)
def test_nothing_is_proved_beyond(change: dict[str, int]) -> None:
    claim = replace(asked("s65", "x", **change), scenario=None)
    lemmas = asked("s65", "x").lemmas  # those of the reference
    assert prove(replace(claim, lemmas=lemmas), LIMITS).verdict != PROVED


@pytest.fixture
def also() -> Iterator[None]:
    kept = dict(weak._registry)
    yield
    weak._registry.clear()
    weak._registry.update(kept)


@pytest.mark.slow
@pytest.mark.parametrize("name", [s.id.partition(".")[2] for s in weak.declared() if s.id.startswith("ts7_synthesis")])
def test_all_that_is_declared_comes_out_as_asked(name: str) -> None:
    found = find(of(name), LIMITS)
    assert found.settled
    if name.startswith("least_window"):
        assert (found.refuted_at, found.safe_from) == LEAST_WINDOW[name[-3:]]
    elif name == "greatest_spread_at_s90":
        assert (found.safe_from, found.refuted_at) == (1, 3)
    elif name != "greatest_wheel_error_at_90":
        assert found.exact


@pytest.mark.slow
@pytest.mark.parametrize("spare", [2, 4, 5, 6, 7, 8])
@pytest.mark.parametrize("line", LATE)
def test_the_map_of_least_windows(line: str, spare: int, also: None) -> None:
    """Inside the region, for all spreads and lowerings with so many spare words."""
    least_window(line, spare)
    found = find(of(f"least_window_at_{line}_with_{spare}_spare"), LIMITS)
    proved = Following(WORDS[line], spare).latched + RELEASE
    assert found.safe_from == max(2400, proved)


@pytest.mark.slow
@pytest.mark.parametrize("lowering", range(9))
@pytest.mark.parametrize("line", LATE)
def test_the_map_beyond_the_region(line: str, lowering: int) -> None:
    """At 4000 frames each spread with two spare words or fewer (at 90: one) is refuted by a run: no island is safe."""
    for spread in range(max(1, lowering - (1 if line == "s90" else 2)), 9):
        claim = asked(line, "x", spread, lowering)
        run = search.scripted(stated(claim), claim.scenario, ["claim.holds", "claim.given"])
        assert False in run["claim.holds"], (spread, lowering)


def test_the_table_of_the_docstring_is_what_was_found() -> None:
    for line, (refuted, proved) in LEAST_WINDOW.items():
        assert f"| {line[1:]}     | {proved} (refuted at {refuted})" in (ts7_synthesis.__doc__ or "")


def test_the_greatest_wheel_error_is_where_the_formula_has_it() -> None:
    found = find(of("greatest_wheel_error_at_90"), LIMITS)
    limit = WORD[90] * KMH_PER_WORD.low * (1 + Fraction(100, 10**6))
    exact = 780 * ((90 + 2) / limit - 1)
    assert isinstance(found.safe_from, Fraction)
    assert isinstance(found.refuted_at, Fraction)
    assert found.safe_from <= exact <= found.refuted_at <= found.safe_from + Fraction(1, 10)
    assert found.settled
    assert len(found.proof.agreed_by) == 2


def test_the_map_of_the_docstring_is_what_the_slow_test_proves() -> None:
    told = (ts7_synthesis.__doc__ or "").replace("\n", " ")
    for line, signal in (("s25", "at 25 km/h"), ("s90", "at 90;")):
        least = [max(2400, Following(WORDS[line], spare).latched + RELEASE) for spare in range(2, 9)]
        assert f"{', '.join(map(str, least[:4]))}" in told and signal in told
        assert least[4:] == [2400, 2400, 2400]
