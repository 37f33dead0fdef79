"""Averages over the mission: sums over every state, closed forms, Markov chains, published figures."""

import csv
import math
from dataclasses import replace
from fractions import Fraction

import pytest
from flint import ctx

from safety.rates.markov import Chain
from safety.rates.numeric import transient
from safety.trees import BasicEvent, FaultTree, Gate, TreeError
from safety.trees.expressions.expression import Constant, Operation
from safety.trees.expressions.lifetimes import Glm, PeriodicTest, Weibull
from safety.trees.over_time.averages import averages
from safety.trees.over_time.mission import Mission
from tests.oracles import SHARED
from tests.trees.over_time import L, M, T, ball, expansion, inside, rated, voted


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

    def integral(ahead):
        """Over 500 h from the test of one, `ahead` hours after that of the other."""
        once, later = -math.expm1(-0.05) / 1e-4, math.exp(-1e-4 * ahead)
        return 500 - once * (1 + later) + later * -math.expm1(-0.1) / 2e-4

    exact = (integral(0) + 19 * integral(500)) / 10_000  # the tests of one at 500, 1500, ..., of the other at 1000, ...
    assert sum(staggered.unavailability) / 2 == pytest.approx(exact, rel=1e-11)


def test_estimates_are_called_so():
    """exp(-(t/a)^2) integrates to an error function."""
    found = averages(Mission(voted(1, [Weibull(5000, 2, 0, T)])))
    exact = 1 - 5000 * math.sqrt(math.pi) / 2 * math.erf(8760 / 5000) / 8760
    assert found.method == "estimated" and found.unavailability.low <= exact <= found.unavailability.high
    assert sum(found.expected_failures) / 2 == pytest.approx(-math.expm1(-((8760 / 5000) ** 2)), rel=1e-9)


@pytest.mark.parametrize(
    ("law", "exact"),
    [
        (Weibull(100, "1/2", 0, T), 1 - 200 * (1 - (1 + math.sqrt(87.6)) * math.exp(-math.sqrt(87.6))) / 8760),
        (Constant(1) - Operation("exp", -T / 10), 1 - 10 * -math.expm1(-876) / 8760),
        (Weibull(4000, 30, 0, T), None),
    ],
)
def test_estimates_of_steep_laws(law, exact):
    """Infinitely steep at the start, over after 0.1 % of the mission, or a step in its middle."""
    found = averages(Mission(voted(1, [law])))
    slack = 0.0
    if exact is None:
        slack = 1e-8  # of a sum by middles
        width, steps = 8760 / 20_000, range(20_000)
        exact = math.fsum(-math.expm1(-(((n + 0.5) * width / 4000) ** 30)) for n in steps) / 20_000
    assert found.unavailability.low - slack <= exact <= found.unavailability.high + slack
    assert found.method == "estimated" and found.unavailability.high - found.unavailability.low < 0.01


def test_an_expression_above_one_is_refused():
    with pytest.raises(TreeError, match=r'gives basic event "e0" the probability 2\.0, expected 0 to 1'):
        averages(Mission(voted(1, [T / 10_000], time=8760), 20_000))


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


# --- published figures ------------------------------------------------------------------------------------------------


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


def test_published_frequencies_of_two_of_three():
    """Those of the paper's Markov chain, to which two failures that both were detected are none."""
    for row in table("published/omeiri_2021_table4.csv"):
        rate, coverage = Fraction(row["lambda_D_per_h"]), Fraction(row["DC"])
        rates, test_h = ((1 - coverage) * rate, coverage * rate), Fraction(row["T1_h"])
        tree = channels(2, 3, rates, test_h, Fraction(row["MTTR_h"]), Fraction(0), Fraction(0))
        pairs = [Gate(f"both{i}{j}", "and", (f"du{i}", f"channel{j}")) for i in range(3) for j in range(3) if i != j]
        gates = (*tree.gates[:3], *pairs, Gate("top", "or", tuple(gate.name for gate in pairs)))
        found = averages(Mission(replace(tree, gates=gates)))
        assert found.method == "certified quadrature"
        assert sum(found.frequency) / 2 == pytest.approx(float(row["PFH_Markov"]), rel=5e-3)


def test_a_long_fraction_is_not_written_out():
    events = [BasicEvent(f"e{n}", Fraction(10**16 + n, 10**18)) for n in range(400)]
    tree = FaultTree("t", "top", (Gate("top", "or", [event.name for event in events]),), events)
    found = averages(Mission(tree))
    assert found.exact == 1 - math.prod(1 - event.probability for event in events)
    assert found.plain()["pfd_avg"]["exact"] is None and inside(found.exact, found.unavailability)
