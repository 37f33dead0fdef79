"""Published and independently computed chains (oracles/markov), read in place from outside the project.

The folder is $RIGHTSIDE_ORACLES, else ../shared/oracles beside the project. Rows that belong elsewhere are counted.
"""

import csv
import json
from collections.abc import Callable
from fractions import Fraction
from functools import cache

import pytest

from safety.rates.enclosure import Enclosure
from safety.rates.markov import Chain, availability, mean_reward, mean_time, probability_before
from safety.rates.numeric import Transient, enclose_mean_reward, transient
from safety.rates.two_out_of_three import FAILED, chain
from tests.oracles import SHARED

FOLDER = SHARED / "markov"
ROWS = 85
HOURS_12 = 12 * 3600  # the embedded model counts in seconds

if not FOLDER.is_dir():
    pytest.skip(f"{FOLDER} is absent: {ROWS} oracle rows not checked; set RIGHTSIDE_ORACLES", allow_module_level=True)


def rows(name: str) -> list[dict[str, str]]:
    with (FOLDER / name).open(newline="") as file:
        return list(csv.DictReader(file))


ORACLES = {row["id"]: row for row in rows("oracles.csv")}


@cache
def table(name: str) -> tuple[Chain, dict[str, dict[str, str]]]:
    rates: dict[tuple[str, str], Fraction] = {}
    for row in rows(f"{name}_transitions.csv"):
        if row["from"] != row["to"]:
            rates[row["from"], row["to"]] = rates.get((row["from"], row["to"]), Fraction(0)) + Fraction(row["rate"])
    states = {row["state"]: row for row in rows(f"{name}_states.csv")}
    start = next(s for s, row in states.items() if "init" in row["labels"].split())
    return Chain(start, rates, states), states


def labelled(name: str, label: str) -> set[str]:
    return {s for s, row in table(name)[1].items() if label in row["labels"].split()}


def reward(name: str, column: str) -> dict[str, Fraction]:
    return {s: Fraction(row[f"state_reward_{column}"]) for s, row in table(name)[1].items()}


@cache
def stopped(name: str, at: str) -> Chain:
    """The chain of the table with the states labelled `at` made absorbing."""
    whole, end = table(name)[0], labelled(name, at)
    return Chain(whole.start, {(s, t): rate for (s, t), rate in whole.rates.items() if s not in end}, whole.states)


@cache
def at_time(name: str, time: int, column: str | None, absorbing: str | None) -> Transient:
    whole = stopped(name, absorbing) if absorbing else table(name)[0]
    return transient(whole, time, reward(name, column) if column else None)


def failed(pairs: dict[tuple[str, str], Fraction], start: str = "2") -> Fraction:
    result = mean_time(Chain(start, pairs), {FAILED})
    assert isinstance(result, Fraction)
    return result


def voter_mttf(L: Fraction, mu: Fraction = Fraction(0)) -> Fraction:
    result = mean_time(chain(L, 0, mu), {FAILED})
    assert isinstance(result, Fraction)
    return result


def voter_reliability(L: Fraction, t: Fraction) -> Enclosure:
    return transient(chain(L), t).any_of({"three work", "two work"})


def hot(L: Fraction, mu: Fraction) -> Fraction:
    return failed({("2", "1"): 2 * L, ("1", "2"): mu, ("1", FAILED): L})


def cold(L: Fraction, mu: Fraction) -> Fraction:
    return failed({("2", "1"): L, ("1", "2"): mu, ("1", FAILED): L})


def hot_covered(L: Fraction, c: Fraction) -> Fraction:
    return failed({("2", "1"): 2 * L * c, ("2", FAILED): 2 * L * (1 - c), ("1", FAILED): L})


def simplex(L: Fraction, mu: Fraction) -> Fraction:
    return availability(Chain("1", {("1", "0"): L, ("0", "1"): mu}), {"1"})


def voter_availability(L: Fraction, mu: Fraction) -> Fraction:
    down, up = {(str(n), str(n - 1)): n * L for n in (3, 2, 1)}, {(str(n - 1), str(n)): (4 - n) * mu for n in (3, 2, 1)}
    return availability(Chain("3", down | up), {"3", "2"})


BY_PREFIX: dict[str, Callable[..., Fraction | Enclosure]] = {
    "voter_2oo3_mttf_": voter_mttf,
    "voter_2oo3_repair_": voter_mttf,
    "voter_2oo3_R_": voter_reliability,
    "hot_1oo2_repair_": hot,
    "cold_1oo2_repair_": cold,
    "hot_1oo2_cov_": hot_covered,
    "simplex_availability_": simplex,
    "v2oo3_availability_": voter_availability,
}
CLOSED_FORMS = [i for i in ORACLES if any(i.startswith(prefix) for prefix in BY_PREFIX)]


def series() -> Fraction:
    result = mean_time(Chain("ok", {("ok", "1"): "0.1", ("ok", "2"): "0.2", ("ok", "3"): "0.3"}), {"1", "2", "3"})
    assert isinstance(result, Fraction)
    return result


EXACT: dict[str, Callable[[], Fraction]] = {
    "series_123": series,
    "cluster_n2_premium_steady": lambda: availability(table("cluster_n2")[0], labelled("cluster_n2", "premium")),
}

AT_TIME: dict[str, Callable[[], Enclosure]] = {
    "cluster_n2_below_min": lambda: at_time("cluster_n2", 2000, "time_not_min", None).reward,
    "cluster_n2_qos2": lambda: at_time("cluster_n2", 20, None, None).any_of(not_minimum()),
    "cluster_n2_qos1": lambda: transient(absorbed_below_minimum(), 2000).any_of(not_minimum()),
    "cluster_n2_operational": lambda: operational(20),
    **{
        f"embedded_mc2_{c}_T": lambda c=c: at_time("embedded_mc2", HOURS_12, c, None).reward
        for c in ("up", "danger", "down")
    },
    **{
        f"embedded_mc2_{c}_T": lambda c=c: at_time("embedded_mc2", HOURS_12, None, "down").any_of(
            labelled("embedded_mc2", f"fail_{c}")
        )
        for c in ("io", "main", "sensors")
    },
    "embedded_mc2_failure_T": lambda: at_time("embedded_mc2", HOURS_12, None, "down").any_of(
        labelled("embedded_mc2", "down")
    ),
    # The published row asks for the sensors by a copy error; the true one stands in a row of its own.
    "embedded_mc2_actuators_T": lambda: at_time("embedded_mc2", HOURS_12, None, "down").any_of(
        labelled("embedded_mc2", "fail_sensors")
    ),
    "embedded_mc2_actuators_T_true": lambda: at_time("embedded_mc2", HOURS_12, None, "down").any_of(
        labelled("embedded_mc2", "fail_actuators")
    ),
}

UNTIL_DOWN = ("up_time", "danger_time", "actuators", "io", "main", "sensors")
CHECKED = {*CLOSED_FORMS, *EXACT, *AT_TIME, *(f"embedded_mc2_{q}" for q in UNTIL_DOWN)}


def not_minimum() -> set[str]:
    return set(table("cluster_n2")[1]) - labelled("cluster_n2", "minimum")


def absorbed_below_minimum() -> Chain:
    whole, end = table("cluster_n2")[0], not_minimum()
    return Chain(whole.start, {(s, t): rate for (s, t), rate in whole.rates.items() if s not in end}, whole.states)


def operational(time: int) -> Enclosure:
    at, share = at_time("cluster_n2", time, None, None).probability, reward("cluster_n2", "percent_op")
    return Enclosure(sum(at[s].low * share[s] for s in at), sum(at[s].high * share[s] for s in at))


def agrees(found: Enclosure, row: dict[str, str]) -> bool:
    """The enclosure meets the oracle within the oracle's own tolerance, and is not wider than that."""
    expected = Fraction(row["expected"])
    slack = expected * Fraction(row["tolerance"].removesuffix(" rel"))
    return found.low <= expected + slack and found.high >= expected - slack and found.high - found.low <= 2 * slack


@pytest.mark.parametrize("name", CLOSED_FORMS)
def test_closed_form(name: str) -> None:
    parameters = {k: Fraction(v) for k, v in json.loads(ORACLES[name]["parameters"], parse_float=str).items()}
    found = next(f for prefix, f in BY_PREFIX.items() if name.startswith(prefix))(**parameters)
    if isinstance(found, Enclosure):
        assert agrees(found, ORACLES[name])
    else:
        assert found == Fraction(ORACLES[name]["exact"])


@pytest.mark.parametrize("name", EXACT)
def test_exact(name: str) -> None:
    assert EXACT[name]() == Fraction(ORACLES[name]["exact"])


@pytest.mark.parametrize("name", AT_TIME)
def test_at_a_time(name: str) -> None:
    assert agrees(AT_TIME[name](), ORACLES[name])


def until_down(quantity: str) -> tuple[Chain, set[str], dict[str, Fraction]]:
    """Chain, end and reward whose mean is the quantity: hours in a state, or the rate of the entries that count."""
    whole, down = table("embedded_mc2")[0], labelled("embedded_mc2", "down")
    if quantity.endswith("_time"):
        return whole, down, reward("embedded_mc2", quantity.removesuffix("_time"))
    wanted = labelled("embedded_mc2", f"fail_{quantity}") & down
    return (
        whole,
        down,
        {s: sum((r for t, r in out.items() if t in wanted), Fraction(0)) for s, out in whole.out.items()},
    )


@pytest.mark.parametrize("quantity", UNTIL_DOWN)
def test_until_down_enclosed(quantity: str) -> None:
    found, exact = enclose_mean_reward(*until_down(quantity)), Fraction(ORACLES[f"embedded_mc2_{quantity}"]["exact"])
    assert found.low <= exact <= found.high and found.relative_width < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("quantity", UNTIL_DOWN)
def test_until_down_exact(quantity: str) -> None:
    exact = Fraction(ORACLES[f"embedded_mc2_{quantity}"]["exact"])
    whole, down, gain = until_down(quantity)
    if quantity.endswith("_time"):
        assert mean_reward(whole, down, gain) == exact
    else:
        wanted = labelled("embedded_mc2", f"fail_{quantity}") & down
        assert probability_before(whole, wanted, down - wanted) == exact


def test_a_wrong_transition_moves_the_cluster_off_its_oracle() -> None:
    whole = table("cluster_n2")[0]
    pair = next(iter(whole.rates))
    wrong = Chain(whole.start, {**whole.rates, pair: whole.rates[pair] * Fraction(10**9 + 1, 10**9)}, whole.states)
    assert availability(wrong, labelled("cluster_n2", "premium")) != Fraction(
        ORACLES["cluster_n2_premium_steady"]["exact"]
    )


def test_rows_not_checked_are_counted(capsys: pytest.CaptureFixture[str]) -> None:
    left = sorted(set(ORACLES) - CHECKED)
    groups = sorted({ORACLES[name]["group"] for name in left})
    with capsys.disabled():
        print(f"\noracles/markov: {len(CHECKED)} of {len(ORACLES)} rows checked, {len(left)} not ({', '.join(groups)})")
    assert len(ORACLES) == ROWS and set(ORACLES) >= CHECKED
