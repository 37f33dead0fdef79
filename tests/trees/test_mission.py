"""Curves over the mission time: closed forms, Markov chains and SCRAM."""

import itertools
import math
import re
import subprocess
from dataclasses import replace
from fractions import Fraction

import pytest

from safety.rates.markov import Chain
from safety.rates.numeric import transient
from safety.trees import BasicEvent, FaultTree, Gate, TreeError
from safety.trees.expressions.lifetimes import Exponential, Glm, PeriodicTest
from safety.trees.over_time.averages import averages
from safety.trees.over_time.behaviour import UnknownFrequency
from safety.trees.over_time.mission import Mission
from tests.trees.other_tools import SCRAM
from tests.trees.over_time import L, M, T, voted


def test_two_of_three_without_repair():
    curve = Mission(voted(2, [Exponential(L, T)] * 3)).curve(4)
    assert curve.times_h == (0, 2190, 4380, 6570, 8760)
    for t, down, often, rate in zip(curve.times_h, curve.unavailability, curve.frequency, curve.intensity, strict=True):
        x = math.exp(-1e-4 * t)
        assert down == pytest.approx(1 - 3 * x**2 + 2 * x**3, abs=1e-15)
        assert often == pytest.approx(6e-4 * x**2 * (1 - x), rel=1e-12)
        assert rate == pytest.approx(often / (3 * x**2 - 2 * x**3), rel=1e-12)


def test_repairable_pairs_are_the_markov_chain():
    """Each part fails and is repaired by itself; the chain counts those down."""
    chain = Chain(
        "0", {("0", "1"): 2 * L, ("1", "0"): M, ("1", "2"): L, ("2", "1"): 2 * M}
    )  # fmt: skip
    mission = Mission(voted(2, [Glm(0, L, M, T)] * 2, time=100))
    curve = mission.curve([1, 10, 100])
    for t, down, often in zip((1, 10, 100), curve.unavailability, curve.frequency, strict=True):
        at = transient(chain, Fraction(t))
        assert float(at.probability["2"].middle) == pytest.approx(down, rel=1e-12)
        assert float(at.probability["1"].middle * L) == pytest.approx(often, rel=1e-12)
    found = averages(mission)
    low, high = transient(chain, Fraction(100), {"2": 1}).reward
    assert found.unavailability.low * 100 <= high and low <= found.unavailability.high * 100
    low, high = transient(chain, Fraction(100), {"1": L}).reward
    assert found.expected_failures.low <= high and low <= found.expected_failures.high
    never_left = Chain("0", {pair: rate for pair, rate in chain.rates.items() if pair[0] != "2"})
    unreliability = float(transient(never_left, Fraction(100)).probability["2"].middle)
    assert found.unreliability.low <= unreliability <= found.unreliability.high
    assert found.method == "certified quadrature"


def test_frequency_through_a_negation():
    """The top, x without y: it comes when x fails while y is up, no: while y is down; and goes when y is repaired."""
    names = ("x", "no y")
    tree = FaultTree(
        "t", "top", (Gate("top", "and", names), Gate("no y", "not", ("y",))),
        (BasicEvent("x", expression=Glm(0, L, M, T)), BasicEvent("y", expression=Glm(0, 3 * L, M / 2, T))),
        mission_time_h=50,
    )  # fmt: skip
    rates = {}
    for other in "ud":
        rates |= {("u" + other, "d" + other): L, ("d" + other, "u" + other): M}
        rates |= {(other + "u", other + "d"): 3 * L, (other + "d", other + "u"): M / 2}
    at = transient(Chain("uu", rates), Fraction(50)).probability
    curve = Mission(tree).curve([50])
    assert curve.unavailability[0] == pytest.approx(float(at["du"].middle), rel=1e-12)
    assert curve.frequency[0] == pytest.approx(float(at["uu"].middle * L + at["dd"].middle * M / 2), rel=1e-12)
    found = averages(Mission(tree))
    assert found.method == "estimated"
    assert float(transient(Chain("uu", rates), Fraction(50), {"du": 1}).reward.middle) / 50 == pytest.approx(
        sum(found.unavailability) / 2, rel=1e-9
    )


def test_no_frequency_where_an_event_acts_both_ways_or_does_not_tell():
    laws = {"x": Exponential(L, T), "y": Exponential(L, T)}
    events = tuple(BasicEvent(name, expression=law) for name, law in laws.items())
    xor = FaultTree("t", "top", (Gate("top", "xor", ("x", "y")),), events, mission_time_h=100)
    curve = Mission(xor).curve([100])
    assert curve.frequency is None and curve.unknown == '"x" can both cause and prevent the top event'
    assert curve.plain()["frequency_unknown"] == curve.unknown
    tested = PeriodicTest(L, L, M, 100, 50, 0, 1, 1, 1, 0, T)
    found = averages(Mission(voted(1, [tested], time=500)))
    assert (
        found.frequency is None and found.high_demand is None and "does not tell failures from repairs" in found.unknown
    )
    constant = FaultTree("t", "top", (Gate("top", "or", ("a",)),), (BasicEvent("a", Fraction(1, 2)),), mission_time_h=1)
    assert Mission(constant).curve([1]).unknown == "no event below the top event has a rate"


def test_which_events_follow_the_time():
    """Those whose mission time is the tree's; another's own exposure stays as it is."""
    tree = FaultTree(
        "t", "top", (Gate("top", "or", ("a", "b")),),
        (BasicEvent("a", rate_per_hour=L), BasicEvent("b", rate_per_hour=L, mission_time_h=24)), mission_time_h=1000,
    )  # fmt: skip
    kept = -math.expm1(-24e-4)
    for t, down in zip((0, 500), Mission(tree).curve([0, 500]).unavailability, strict=True):
        assert down == pytest.approx(1 - (1 - kept) * math.exp(-1e-4 * t), rel=1e-12)
    events = tuple(replace(event, mission_time_h=hours) for hours, event in enumerate(tree.events, 1))
    loose = replace(tree, events=events, mission_time_h=None)
    with pytest.raises(TreeError, match='"a" and "b" have mission times of 1 h and 2 h; give fault tree "t"'):
        Mission(loose)


@pytest.mark.skipif(SCRAM is None, reason="the program scram is not installed (Debian package scram)")
def test_scram_draws_the_same_curve(tmp_path):
    def number(x):
        return f'<float value="{float(x)!r}"/>'

    laws = {
        "exponential": [L], "GLM": [Fraction(1, 100), L, Fraction(1, 200)], "periodic-test": [L, 700, 300],
    }  # fmt: skip
    events = "".join(
        f'<define-basic-event name="{tag}"><{tag}>{"".join(map(number, given))}<system-mission-time/></{tag}>'
        "</define-basic-event>"
        for tag, given in laws.items()
    )
    inputs = "".join(f'<basic-event name="{tag}"/>' for tag in laws)
    (tmp_path / "curve.xml").write_text(
        f'<opsa-mef><define-fault-tree name="t"><define-gate name="top"><atleast min="2">{inputs}</atleast>'
        f"</define-gate></define-fault-tree><model-data>{events}</model-data></opsa-mef>"
    )
    printed = subprocess.run(
        [SCRAM, "--sil", "1", "--mission-time", "4000", "--time-step", "250", tmp_path / "curve.xml"],
        check=True, capture_output=True, text=True, timeout=60,
    ).stdout  # fmt: skip
    points = [(float(x), float(y)) for x, y in re.findall(r'<point X="([^"]+)" Y="([^"]+)"', printed)]
    mission = Mission(voted(2, [Exponential(L, T), Glm("1/100", L, "1/200", T), PeriodicTest(L, 700, 300, T)], 4000))
    curve = mission.curve([Fraction(x) for x, _ in points])
    assert len(points) == 17
    assert curve.unavailability == pytest.approx([y for _, y in points], rel=1e-5)
    down = curve.unavailability
    trapezes = sum((a + b) / 2 for a, b in itertools.pairwise(down)) / 16
    assert trapezes == pytest.approx(float(re.search(r'PFD-avg="([^"]+)"', printed)[1]), rel=1e-5)


def test_what_cannot_be_asked():
    tree = FaultTree("t", "top", (Gate("top", "or", ("a",)),), (BasicEvent("a", Fraction(1, 2)),))
    assert averages(Mission(tree)).exact == Fraction(1, 2)  # whatever the time
    with pytest.raises(TreeError, match="the mission time is 0 h, expected more than 0"):
        Mission(tree, 0)
    with pytest.raises(TreeError, match="a curve of 0 steps was asked for"):
        Mission(tree, 1).curve(0)
    with pytest.raises(TreeError, match="a time of the curve is -1 h, expected 0 or more"):
        Mission(tree, 1).curve([-1])
    with pytest.raises(TreeError, match='"a" has no probability, so nothing can be said over time'):
        Mission(replace(tree, events=(BasicEvent("a"),)), 1)
    with pytest.raises(TreeError, match="more than 20000 tests; take a shorter one"):
        averages(Mission(voted(1, [PeriodicTest(L, 1, 1, T)], 200_000)))


@pytest.mark.parametrize(
    ("event", "why"),
    [
        (BasicEvent("a", rate_per_hour=L, mission_time_h=10), "its exposure time of its own, 10 h"),
        (BasicEvent("a", expression=T * L, mission_time_h=10), "its exposure time of its own, 10 h"),
        (BasicEvent("a", expression=Exponential(L, 10)), "its <exponential> is of a fixed time"),
        (BasicEvent("a", "0.1", L), "it has a probability beside its rate"),
    ],
)
def test_no_frequency_where_an_exposure_is_not_the_missions(event, why):
    for others in ((), (BasicEvent("b", rate_per_hour=L),)):
        names = ("a", *(other.name for other in others))
        # with a time the probability of which agrees with its rate
        hours = 1053.6 if event.probability is not None else 1000
        gates = (Gate("top", "or", names), Gate("apart", "or", ("c", *names)))
        events = (event, *others, BasicEvent("c", rate_per_hour=L, mission_time_h=1))
        tree = FaultTree("t", "top", gates, events, mission_time_h=hours)
        found, curve = averages(Mission(tree)), Mission(tree).curve(2)
        assert found.frequency is found.high_demand is curve.frequency is found.unreliability is None
        assert found.unknown.startswith(f'"a": {why}') and curve.unknown == found.unknown
        assert found.unavailability.high > 1e-3 / 2
        with pytest.raises(UnknownFrequency, match='"c"'):
            Mission(replace(tree, top="apart", events=(BasicEvent("a", "0.1"), *events[1:]))).occurrences([])


def test_repairs_that_balance_failures_leave_failures():
    found = averages(Mission(voted(1, [Glm("1/2", L, L, T)])))
    assert found.unavailability.low <= 0.5 <= found.unavailability.high
    assert found.frequency.low <= 0.5e-4 <= found.frequency.high < 0.6e-4


@pytest.mark.parametrize("time", ["1e400", "1e-400", "1e120", "1e-120"])
def test_times_beyond_all_doubles(time):
    with pytest.raises(
        TreeError, match=f"the mission time is {time.replace('e1', 'e.1').replace('e4', 'e.4')}, expected"
    ):
        Mission(voted(1, [Exponential(L, T)]), time)
    with pytest.raises(TreeError, match=r"a time of the curve is 1e.*, expected 0 or a number from 1e-100"):
        Mission(voted(1, [Exponential(L, T)]), 100).curve([time])


def test_a_slow_repair_after_a_test_does_not_overflow():
    """At first it fails, soon for good: the integral of 1 - exp(-t) over 5000 h."""
    found = averages(Mission(voted(1, [PeriodicTest(1, "1e-9", 1000, 1000, T)], 5000)))
    assert sum(found.unavailability) / 2 == pytest.approx(1 - 1 / 5000, rel=1e-8)
    assert sum(found.expected_failures) / 2 == pytest.approx(1, rel=1e-5)
