"""Curves, averages and mean times: closed forms, Markov chains, sums over every state, SCRAM, published tables."""

import cmath
import csv
import itertools
import math
import re
import subprocess
from dataclasses import replace
from fractions import Fraction

import pytest
from flint import arb, ctx, fmpq

from safety.rates.markov import Chain, mean_time
from safety.rates.numeric import transient
from safety.trees import BasicEvent, FaultTree, Gate, TreeError, quadrature
from safety.trees import mean_time as mean_time_module
from safety.trees.averages import averages
from safety.trees.behaviour import AfterTest
from safety.trees.expressions import MissionTime, Operation
from safety.trees.lifetimes import Exponential, Glm, PeriodicTest, Weibull
from safety.trees.mean_time import mean_time_to_failure
from safety.trees.mission import Mission
from tests.oracles import SHARED
from tests.trees.other_tools import SCRAM
from tests.trees.random_trees import random_tree

L, M, T = Fraction(1, 10**4), Fraction(1, 10), MissionTime()


def voted(k, laws, time=8760):
    """Top if k of the events with these expressions occur."""
    names = tuple(f"e{i}" for i in range(len(laws)))
    events = tuple(BasicEvent(name, expression=law) for name, law in zip(names, laws, strict=True))
    return FaultTree("voted", "top", (Gate("top", "vote", names, k),), events, mission_time_h=time)


def inside(exact, bounds):
    """Whether a rational or a ball lies within, and the bounds are narrow."""
    low, high = map(Fraction, bounds)
    if not isinstance(exact, Fraction):
        exact, wide = (Fraction(*map(int, fmpq_of(end))) for end in (exact.mid(), exact.rad()))
        low, high = low + wide, high - wide
    return low <= exact <= high and high - low <= Fraction(1, 10**9) * abs(high)


def fmpq_of(x):
    mantissa, exponent = x.man_exp()
    value = Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
    return value.as_integer_ratio()


# --- curves -----------------------------------------------------------------------------------------------------------


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


# --- averages and mean times against sums over every state ------------------------------------------------------------


def rated(seed, **more):
    """A random coherent tree some events of which have rates."""
    tree = random_tree(seed, events=6, coherent=True)
    events = tuple(
        event if n % 3 == 2 else BasicEvent(event.name, rate_per_hour=Fraction(3 * n + 1, 10 ** (3 + n)))
        for n, event in enumerate(tree.events)
    )
    return replace(tree, events=events, mission_time_h=Fraction(5000), **more)


def expansion(tree):
    """Q(t) as {rate: coefficient}, over all states."""
    total = {}
    for flags in itertools.product((False, True), repeat=len(tree.events)):
        if not tree.occurs({event.name for event, flag in zip(tree.events, flags, strict=True) if flag}):
            continue
        terms = {Fraction(0): Fraction(1)}
        for event, failed in zip(tree.events, flags, strict=True):
            if event.probability is not None:
                factor = {Fraction(0): event.probability if failed else 1 - event.probability}
            elif failed:
                factor = {Fraction(0): Fraction(1), event.rate_per_hour: Fraction(-1)}
            else:
                factor = {event.rate_per_hour: Fraction(1)}
            new = {}
            for (a, c), (b, d) in itertools.product(terms.items(), factor.items()):
                new[a + b] = new.get(a + b, 0) + c * d
            terms = new
        for rate, c in terms.items():
            total[rate] = total.get(rate, 0) + c
    return {rate: c for rate, c in total.items() if c}


def ball(x):
    return arb(fmpq(x.numerator, x.denominator))


@pytest.mark.parametrize("seed", range(30))
def test_averages_of_random_trees(seed):
    tree = rated(seed)
    terms, hours = expansion(tree), tree.mission_time_h
    found = averages(Mission(tree))
    with ctx.workprec(300):
        _compare(found, terms, hours)


def _compare(found, terms, hours):
    if set(terms) <= {0}:
        if not terms:
            assert found.unavailability.low == 0 and found.unavailability.high < 1e-300
        else:
            assert inside(Fraction(1), found.unavailability)
        return
    rest = {rate: c for rate, c in terms.items() if rate}
    mean = ball(Fraction(terms.get(0, 0)))
    for rate, c in rest.items():
        mean += ball(c / (rate * hours)) * (1 - ball(-rate * hours).exp())
    assert found.method == "certified quadrature" and inside(mean, found.unavailability)
    failures = sum(ball(c) * (ball(-rate * hours).exp() - 1) for rate, c in rest.items())  # Q(T) - Q(0)
    assert inside(failures, found.expected_failures)
    start = Fraction(sum(terms.values()))
    assert inside(failures + ball(start), found.unreliability)  # nothing is repaired: it is Q(T) itself


@pytest.mark.parametrize("seed", range(30))
def test_mean_times_of_random_trees(seed, monkeypatch):
    tree = rated(seed)
    terms = expansion(tree)
    if set(terms) <= {0}:
        return
    exact = sum(-c / rate for rate, c in terms.items() if rate)
    found = mean_time_to_failure(tree)
    if terms.get(0, 0) != 1:
        assert found.method == "infinite" and found.never == pytest.approx(float(1 - terms.get(0, 0)))
        assert found.plain()["value"] == "inf"
        return
    assert found.exact == exact and inside(exact, found.bounds)
    monkeypatch.setattr(mean_time_module, "MOST_TERMS", 0)
    by_quadrature = mean_time_to_failure(tree)
    assert by_quadrature.exact is None and inside(exact, by_quadrature.bounds)


@pytest.mark.parametrize("tolerance", [1e-1, 1e-3, 1e-6])
def test_the_error_of_a_rule_is_within_its_bound(tolerance, monkeypatch):
    """Coarse rules, so that the error is far above rounding."""
    monkeypatch.setattr(quadrature, "TOLERANCE", tolerance)
    mission = Mission(voted(2, [Exponential(L, T)] * 3))
    for low, high in ((0, 10_000), (4000, 8000), (20_000, 40_000), (0, 100_000)):
        given = list(quadrature.rules(mission.events, quadrature.Panel(Fraction(0), low, high), 1.0))
        places = [place for rule in given for place in rule.places()]
        down = mission.solution.many(mission.columns([place for place, _ in places]))
        found = math.fsum(w * q for (_, w), q in zip(places, down, strict=True))
        two, three = ((math.exp(-k * 1e-4 * low) - math.exp(-k * 1e-4 * high)) / (k * 1e-4) for k in (2, 3))
        assert (
            abs(found - (high - low - 3 * two + 2 * three)) <= sum(rule.cut for rule in given) <= 2 * tolerance * high
        )


LAWS = [
    (Exponential(L, T), lambda z: cmath.exp(-1e-4 * z)),
    (Glm("0.3", L, M, T), lambda z: 1 - (1e-4 / 0.1001 + (0.3 - 1e-4 / 0.1001) * cmath.exp(-0.1001 * z))),
    (Operation("mul", Fraction(1, 4), Exponential(L, T)), lambda z: 0.75 + cmath.exp(-1e-4 * z) / 4),
]


@pytest.mark.parametrize(("law", "up"), LAWS)
@pytest.mark.parametrize("panel", [(0, 10), (10, 20), (0, 3000), (50_000, 100_000), (0, 6000)])
def test_growth_bounds_the_ellipse(law, up, panel):
    """On the boundary of the ellipse, where analytic functions are largest."""
    (event,) = Mission(voted(1, [law])).events
    middle, half = sum(panel) / 2, (panel[1] - panel[0]) / 2
    bound = event.growth(middle - 3 * half, math.sqrt(8) * half)
    for n in range(200):
        angle = 2 * math.pi * n / 200
        u = up(middle + half * complex(3 * math.cos(angle), math.sqrt(8) * math.sin(angle)))
        assert math.log(abs(u) + abs(1 - u)) <= bound + 1e-9


@pytest.mark.parametrize("rates", [(1e-4, 0.1), (0.1, 1e-4), (0.01, 0.01)])
@pytest.mark.parametrize("panel", [(0, 10), (10, 20), (0, 300), (300, 600)])
def test_growth_bounds_the_ellipse_after_a_test(rates, panel):
    fails, repairs = rates
    after = AfterTest(fails, repairs, 0.4, 1.0)
    middle, half = sum(panel) / 2, (panel[1] - panel[0]) / 2
    bound = after.growth(middle - 3 * half, math.sqrt(8) * half)
    for n in range(200):
        angle = 2 * math.pi * n / 200
        z = middle + half * complex(3 * math.cos(angle), math.sqrt(8) * math.sin(angle))
        fails_only, repairs_only = cmath.exp(-fails * z), cmath.exp(-repairs * z)
        apart = repairs - fails
        back = repairs * (z * fails_only if not apart else (fails_only - repairs_only) / apart)
        u = 0.6 * cmath.exp(-fails * z) + 0.4 * back
        assert math.log(abs(u) + abs(1 - u)) <= bound + 1e-9
    assert 1 - after.unscaled(50) == pytest.approx(0.6 * math.exp(-fails * 50) + 0.4 * after._back(50))


def test_mean_time_is_that_of_the_chain():
    chain = Chain("3", {("3", "2"): 3 * L, ("2", "failed"): 2 * L})
    assert mean_time_to_failure(voted(2, [Exponential(L, T)] * 3)).exact == mean_time(chain, {"failed"})


def test_mean_times_of_very_different_rates(monkeypatch):
    laws = [Exponential(Fraction(1, 10**n), T) for n in (1, 4, 8)]
    monkeypatch.setattr(mean_time_module, "MOST_TERMS", 0)
    for k in (1, 2, 3):
        found = mean_time_to_failure(voted(k, laws))
        monkeypatch.undo()
        exact = mean_time_to_failure(voted(k, laws)).exact
        monkeypatch.setattr(mean_time_module, "MOST_TERMS", 0)
        assert found.exact is None and inside(exact, found.bounds)


def test_mean_time_is_refused_where_it_is_not_the_integral():
    with pytest.raises(TreeError, match='"e0" is repaired, tested or of no constant failure rate'):
        mean_time_to_failure(voted(1, [Glm(0, L, M, T)]))
    with pytest.raises(TreeError, match='"e0" is repaired, tested'):
        mean_time_to_failure(voted(1, [Weibull(100, 2, 0, T)]))
    tree = voted(1, [Exponential(L, T)])
    negated = replace(tree, top="none", gates=(*tree.gates, Gate("none", "not", ("top",))))
    with pytest.raises(TreeError, match='"e0" can prevent the top event'):
        mean_time_to_failure(negated)
    # scaled by 1/2 it may never fail
    assert mean_time_to_failure(voted(1, [Operation("mul", Fraction(1, 2), Exponential(L, T))])).never == 0.5


# --- periodic tests ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("k", "n"), [(1, 1), (2, 2), (1, 2), (2, 3), (3, 3)])
@pytest.mark.parametrize("first", [1000, 250])
def test_periodic_tests(k, n, first):
    """Tests every 1000 h; the mission ends 400 h after one."""
    law = PeriodicTest(L, 1000, first, T)
    found = averages(Mission(voted(k, [law] * n, time=first + 2400)))

    def integral(hours):
        """Of the probability that k of n are down, over the hours since a test."""
        total = 0.0
        for j in range(k, n + 1):
            for i in range(j + 1):  # (1-x)^j x^(n-j), x = exp(-rate t)
                s = 1e-4 * (n - j + i)
                total += (
                    math.comb(n, j) * math.comb(j, i) * (-1) ** i * (hours if s == 0 else -math.expm1(-s * hours) / s)
                )
        return total

    whole = integral(first) + 2 * integral(1000) + integral(400)
    assert found.unavailability.low * (1 - 1e-9) <= whole / (first + 2400) <= found.unavailability.high * (1 + 1e-9)
    assert found.unavailability.high <= found.unavailability.low * (1 + 1e-11)
    assert found.method == "certified quadrature"
    x = math.exp(-1e-4 * 1000)
    peak = sum(math.comb(n, j) * (1 - x) ** j * x ** (n - j) for j in range(k, n + 1))
    assert found.largest_unavailability == pytest.approx(peak)


def test_staggered_tests_are_better_than_those_at_once():
    at_once, staggered = (
        averages(Mission(voted(2, [PeriodicTest(L, 1000, 1000, T), PeriodicTest(L, 1000, first, T)], 10000)))
        for first in (1000, 500)
    )
    assert staggered.unavailability.high < 0.7 * at_once.unavailability.low


def test_estimates_are_called_so():
    """exp(-(t/a)^2) integrates to an error function."""
    found = averages(Mission(voted(1, [Weibull(5000, 2, 0, T)])))
    exact = 1 - 5000 * math.sqrt(math.pi) / 2 * math.erf(8760 / 5000) / 8760
    assert found.method == "estimated" and found.unavailability.low <= exact <= found.unavailability.high
    assert sum(found.expected_failures) / 2 == pytest.approx(-math.expm1(-((8760 / 5000) ** 2)), rel=1e-9)


def test_repair_after_a_test_is_that_of_the_chain():
    """Up, failed unseen, in repair; a test turns failed into in repair."""
    law = PeriodicTest(L, M, 500, 500, T)
    found = averages(Mission(voted(1, [law], time=2000)))
    chain = {("up", "failed"): L, ("repair", "up"): M}
    state, down, often = {"up": Fraction(1), "failed": Fraction(0), "repair": Fraction(0)}, Fraction(0), Fraction(0)
    for _ in range(4):
        after = dict.fromkeys(state, Fraction(0))
        for start, weight in state.items():
            run = transient(Chain(start, chain, state), Fraction(500), {"failed": 1, "repair": 1})
            down += weight * run.reward.middle
            often += weight * transient(Chain(start, chain, state), Fraction(500), {"up": L}).reward.middle
            for end in state:
                after[end] += weight * run.probability[end].middle
        state = {"up": after["up"], "failed": Fraction(0), "repair": after["repair"] + after["failed"]}
    assert sum(found.unavailability) / 2 == pytest.approx(float(down / 2000), rel=1e-9)
    assert sum(found.expected_failures) / 2 == pytest.approx(float(often), rel=1e-9)


# --- what others say --------------------------------------------------------------------------------------------------


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


def channels(k, n, row_rates, test_h, repair_h, beta, beta_detected):
    """k of n channels to fail, each undetected (found by a test) or detected; and their common causes."""
    undetected, detected = row_rates
    repair = 1 / Fraction(repair_h)
    names, events, gates = [], [], []
    for i in range(n):
        own = {f"du{i}": PeriodicTest((1 - beta) * undetected, repair, test_h, test_h, T),
               f"dd{i}": Glm(0, (1 - beta_detected) * detected, repair, T)}  # fmt: skip
        events += [BasicEvent(name, expression=law) for name, law in own.items()]
        gates.append(Gate(f"channel{i}", "or", tuple(own)))
        names.append(f"channel{i}")
    common = {
        "du": PeriodicTest(beta * undetected, repair, test_h, test_h, T),
        "dd": Glm(0, beta_detected * detected, repair, T),
    }
    events += [BasicEvent(name, expression=law) for name, law in common.items()]
    gates += [Gate("voted", "vote", tuple(names), k), Gate("top", "or", ("voted", *common))]
    return FaultTree("t", "top", tuple(gates), tuple(events), mission_time_h=test_h)


NEEDED = {"1oo1": (1, 1), "1oo2": (2, 2), "2oo2": (1, 2), "2oo3": (2, 3), "1oo3": (3, 3)}  # failures of channels


def table(name):
    path = SHARED / name
    if not path.exists():
        pytest.skip(f"no data at {path}")
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def in_the_long_run(tree):
    """PFDavg from the third test to the fourth."""
    three, four = (sum(averages(Mission(tree, n * tree.mission_time_h)).unavailability) / 2 for n in (3, 4))
    return 4 * four - 3 * three


def test_published_averages_of_channels():
    """The formula of the standard is of first order, so its figures are near the exact ones, a little above."""
    for row in table("published/dolan_2024.csv"):
        if row["row"] == "sum":
            continue
        rates = Fraction(row["lambda_DU_per_h"]), Fraction(row["lambda_DD_per_h"])
        beta, detected = (Fraction(row[name]) / 100 for name in ("beta_percent", "betaD_percent"))
        tree = channels(*NEEDED[row["arch"]], rates, Fraction(row["T1_h"]), Fraction(row["MRT_h"]), beta, detected)
        found = in_the_long_run(tree)
        assert found == pytest.approx(float(row["PFDavg_full"]), rel=0.01)
        if "counterpart" in row["note"]:
            assert found == pytest.approx(float(row["note"].split("counterpart")[1]), rel=2e-3)


def test_published_tables_of_channels():
    """Cells without diagnostics: the formula is too high, by a part of the order of rate x test interval."""
    cells = [row for row in table("iec61508/tables.csv") if row["measure"] == "PFDavg" and row["status"] == "match"]
    compared = printed = 0
    for row in cells:
        rate, test_h, beta = Fraction(row["lambda_D_per_h"]), Fraction(row["T1_h"]), Fraction(row["beta_percent"]) / 100
        if row["dc_percent"] != "0" or rate * test_h > Fraction(1, 20):
            continue
        tree = channels(*NEEDED[row["arch"]], (rate, Fraction(0)), test_h, Fraction(8), beta, Fraction(0))
        found = in_the_long_run(tree)
        formula = float(row["formula_value"])
        assert formula * (1 - 1.1 * float(rate * test_h)) <= found <= formula * (1 + 1e-9), row
        compared += 1
        printed += f"{found:.1E}" == row["printed"]
    assert compared > 50 and printed > 0.9 * compared


# --- limits -----------------------------------------------------------------------------------------------------------


def test_what_cannot_be_asked():
    tree = FaultTree("t", "top", (Gate("top", "or", ("a",)),), (BasicEvent("a", Fraction(1, 2)),))
    with pytest.raises(TreeError, match='fault tree "t" has no mission time; give it mission_time_h'):
        Mission(tree)
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
