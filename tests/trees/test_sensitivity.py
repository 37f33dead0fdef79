"""Sensitivity: derivatives against differences, tornado bars against trees solved anew, targets checked exactly."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import pytest

from safety.trees.as_written import TreeError
from safety.trees.expressions.distributions import Lognormal, Uniform
from safety.trees.expressions.expression import Expression, MissionTime, Parameter
from safety.trees.expressions.lifetimes import Exponential, PeriodicTest
from safety.trees.expressions.readings import MISSION_TIME
from safety.trees.solve import solve
from safety.trees.tree import BasicEvent, FaultTree, Gate
from safety.trees.uncertainty.sensitivity import derivatives, fields, tornado
from safety.trees.uncertainty.targets import meets


def bridge(rate: Expression | str = "2e-4", p: Expression | str = "0.03", beta: Expression | str = "0.1") -> FaultTree:
    """Two of three channels with a common cause, or a tested part together with a rated one."""
    rate, p, beta = (
        each if isinstance(each, Expression) else Parameter(name, each)
        for name, each in (("rate", rate), ("p", p), ("beta", beta))
    )
    single = Exponential(rate * (Parameter("one", 1) - beta), MissionTime())
    events = (
        *(BasicEvent(f"channel {n}", expression=single) for n in (1, 2, 3)),
        BasicEvent("common", expression=Exponential(rate * beta, MissionTime())),
        BasicEvent("tested", expression=PeriodicTest(rate, "0.01", 100, 10, MissionTime())),
        BasicEvent("rated", rate_per_hour=Fraction("1e-3")),
        BasicEvent("fixed", expression=p * p),
        BasicEvent("plain", Fraction("0.2")),
    )
    gates = (
        Gate("top", "or", ("two", "common", "both")),
        Gate("two", "vote", ("channel 1", "channel 2", "channel 3"), 2),
        Gate("both", "and", ("tested", "rated", "not fixed", "plain")),
        Gate("not fixed", "not", ("fixed",)),
    )
    return FaultTree("bridge", "top", gates, events, mission_time_h=Fraction(250))


def top(tree: FaultTree) -> float:
    probability = solve(tree).probability
    assert probability is not None
    return probability


AT: dict[str, tuple[Callable[[Fraction], FaultTree], Fraction]] = {
    "rate": (lambda x: bridge(rate=str(x)), Fraction("2e-4")),
    "p": (lambda x: bridge(p=str(x)), Fraction("0.03")),
    "beta": (lambda x: bridge(beta=str(x)), Fraction("0.1")),
    MISSION_TIME: (
        lambda x: replace(
            bridge(),
            mission_time_h=x,
            events=tuple(replace(e, mission_time_h=None) for e in bridge().events),
        ),
        Fraction(250),
    ),
}


@pytest.mark.parametrize("name", AT)
def test_derivatives_by_parameters_are_those_of_differences(name: str) -> None:
    make, x = AT[name]
    found = {one.name: one for one in derivatives(solve(bridge()))}[name]
    h = x / 10_000
    slope = (top(make(x - 2 * h)) - 8 * top(make(x - h)) + 8 * top(make(x + h)) - top(make(x + 2 * h))) / (
        12 * float(h)
    )
    assert found.derivative == pytest.approx(slope, rel=1e-8)
    assert found.value == float(x)
    assert found.elasticity == pytest.approx(float(x) * slope / top(bridge()), rel=1e-8)


def rational(p: Fraction = Fraction(1, 7), q: Fraction = Fraction(2, 5)) -> FaultTree:
    """A tree whose probability is rational: a polynomial in p and q."""
    x, y = Parameter("p", p), Parameter("q", q)
    events = (
        BasicEvent("a", expression=x),
        BasicEvent("b", expression=x * y),
        BasicEvent("c", expression=y * Uniform("0.2", "0.4")),
        BasicEvent("d", Fraction(1, 9)),
    )
    gates = (Gate("top", "vote", ("a", "b", "c", "d"), 2),)
    return FaultTree("rational", "top", gates, events)


@pytest.mark.parametrize("name", ["p", "q"])
def test_a_derivative_of_a_polynomial_is_exact(name: str) -> None:
    """By Lagrange's interpolation of the exact values at enough points, in rationals."""
    x = {"p": Fraction(1, 7), "q": Fraction(2, 5)}[name]
    points = [x + Fraction(n, 100) for n in range(-3, 4)]
    values = [solve(rational(**{name: each})).exact for each in points]
    slope = Fraction(0)
    for i, (xi, yi) in enumerate(zip(points, values, strict=True)):
        assert yi is not None
        others = [xj for j, xj in enumerate(points) if j != i]
        for skipped in others:
            term = yi / (xi - skipped)
            for xj in others:
                if xj != skipped:
                    term *= (x - xj) / (xi - xj)
            slope += term
    found = {one.name: one for one in derivatives(solve(rational()))}[name]
    assert found.derivative == pytest.approx(float(slope), rel=1e-14)


def test_the_derivative_by_an_event_is_birnbaum() -> None:
    solution = solve(rational())
    found = {one.name: one.derivative for one in derivatives(solution)}
    exact = solution.exact_importance()
    assert {name: found[name] for name in "abcd"} == pytest.approx(
        {n: float(exact[n].birnbaum) for n in "abcd"}, rel=1e-14
    )
    assert "p" in found and MISSION_TIME not in found


def test_tornado_bars_are_trees_solved_anew() -> None:
    uncertain = bridge(rate=Parameter("rate", Lognormal("2e-4", 3, "0.95")), p=Parameter("p", Uniform(0, "0.5")))
    bars = tornado(solve(uncertain), {"plain": ("0.1", "0.5"), "beta": (0, "0.2")})
    assert {bar.name for bar in bars} == {"rate", "p", "plain", "beta"}
    assert [bar.swing for bar in bars] == sorted((bar.swing for bar in bars), reverse=True)
    for bar in bars:
        for x, value in ((bar.low, bar.top_low), (bar.high, bar.top_high)):
            if bar.name == "plain":
                events = tuple(
                    replace(e, probability=Fraction(x)) if e.name == "plain" else e for e in bridge(p="0.25").events
                )
                changed = replace(bridge(p="0.25"), events=events)
            else:
                changed = bridge(**({"p": "0.25"} | {bar.name: repr(x)}))  # type: ignore[arg-type]
            assert value == pytest.approx(top(changed), rel=1e-12), bar
    by_name = {bar.name: bar for bar in bars}
    assert (by_name["p"].low, by_name["p"].high) == pytest.approx((0.025, 0.475))
    assert by_name["rate"].high / by_name["rate"].low == pytest.approx(9)


def test_the_fields_of_a_results_document() -> None:
    plain, uncertain = fields(solve(bridge())), fields(solve(rational()))
    assert plain["tornado"] == [] and set(plain["derivatives"][0]) == {
        "name",
        "kind",
        "value",
        "derivative",
        "elasticity",
    }
    assert [bar["name"] for bar in uncertain["tornado"]] == ["c/2"]
    assert [bar["name"] for bar in fields(solve(bridge()), {"p": (0, 1)})["tornado"]] == ["p"]


def test_a_range_replaces_the_distribution_of_a_parameter() -> None:
    (bar,) = tornado(solve(bridge(p=Parameter("p", Uniform(0, "0.5")))), {"p": ("0.1", "0.2")})
    assert (bar.low, bar.high) == (0.1, 0.2)
    assert bar.top_low == pytest.approx(top(bridge(p="0.1")), rel=1e-14)


def test_the_range_of_a_variable_goes_by_the_means_of_its_own_parameters() -> None:
    centre = Parameter("centre", "0.1")
    law = Parameter("p", Uniform(0, centre))
    tree = FaultTree("t", "g", (Gate("g", "or", ("e",)),), (BasicEvent("e", expression=law),))
    bars = {bar.name: bar for bar in tornado(solve(tree), {"centre": ("0.4", "0.8")})}
    assert (bars["p"].low, bars["p"].high) == pytest.approx((0.005, 0.095))
    assert (bars["centre"].top_low, bars["centre"].top_high) == pytest.approx((0.2, 0.4))


def test_a_test_interval_is_varied_with_the_number_of_tests() -> None:
    def tested(interval: str) -> FaultTree:
        law = PeriodicTest("1e-3", "0.01", Parameter("interval", interval), 10, MissionTime())
        return FaultTree("t", "g", (Gate("g", "or", ("e",)),), (BasicEvent("e", expression=law),), mission_time_h=1000)

    (bar,) = tornado(solve(tested("99")), {"interval": (33, 990)})
    assert (bar.top_low, bar.top_high) == pytest.approx((top(tested("33")), top(tested("990"))), rel=1e-13)


@pytest.mark.parametrize(("name", "target"), [("p", "0.1"), ("q", "0.2"), ("d", "0.25"), ("p", "1/3"), ("a", "0.05")])
def test_a_target_lies_between_the_ends_in_exact_arithmetic(name: str, target: str) -> None:
    found = meets(solve(rational()), name, target)
    assert found.exact and 0 < found.high - found.low < 1e-11

    def at(x: float) -> Fraction:
        if name in "pq":
            value = solve(rational(**{name: Fraction(x)})).exact
        else:
            events = tuple(
                BasicEvent(name, Fraction(x)) if event.name == name else event for event in rational().events
            )
            value = solve(replace(rational(), events=events)).exact
        assert value is not None
        return value

    assert min(at(found.low), at(found.high)) <= Fraction(target) <= max(at(found.low), at(found.high))


def test_a_crossing_that_doubles_misjudge_is_widened_until_it_holds() -> None:
    """The top hardly depends on "d": in doubles it is flat over long stretches."""

    def tree(d: Fraction) -> FaultTree:
        gates = (Gate("top", "or", ("big", "both")), Gate("both", "and", ("tiny", "d")))
        events = (BasicEvent("big", Fraction(1, 3)), BasicEvent("tiny", Fraction("1e-14")), BasicEvent("d", d))
        return FaultTree("flat", "top", gates, events)

    target = solve(tree(Fraction(1, 7))).exact
    assert target is not None
    found = meets(solve(tree(Fraction(1, 2))), "d", target)
    ends = [solve(tree(Fraction(end))).exact or Fraction(0) for end in (found.low, found.high)]
    assert found.exact and ends[0] <= target <= ends[1] and found.low <= 1 / 7 <= found.high


def test_a_target_for_an_irrational_tree() -> None:
    found = meets(solve(bridge()), "rate", "1e-3")
    assert not found.exact and found.high - found.low < 1e-12 * found.high
    assert top(bridge(rate=repr(found.low))) <= 1e-3 <= top(bridge(rate=repr(found.high)))
    assert meets(solve(bridge()), "rate", "0.5", start="1e-9").low == pytest.approx(
        meets(solve(bridge()), "rate", "0.5").low, rel=1e-12
    )


@pytest.mark.parametrize(
    ("run", "message"),
    [
        (
            lambda: meets(solve(rational()), "x", "0.1"),
            '"x" is neither a parameter nor a basic event .* a, b, c, d, p, q',
        ),
        (lambda: meets(solve(rational()), "d", "1.5"), "expected a probability between 0 and 1"),
        (
            lambda: meets(solve(rational()), "d", "0.999"),
            'no value of "d" was found that brings the top event to 0.999',
        ),
        (lambda: meets(solve(rational()), "d", "1e-9"), "stays above the target"),
        (lambda: tornado(solve(rational()), {"x": (0, 1)}), '"x" is neither'),
        (lambda: tornado(solve(rational()), {"d": (0, 2)}), "2.0"),
    ],
)
def test_questions_without_an_answer_are_refused(run: Callable[[], object], message: str) -> None:
    with pytest.raises(TreeError, match=message):
        run()


def one(kind: str, *events: BasicEvent, time: int | None = None) -> FaultTree:
    """One gate over the events."""
    gate = Gate("top", kind, tuple(event.name for event in events))
    return FaultTree("t", "top", (gate,), events, mission_time_h=None if time is None else Fraction(time))


def test_a_leap_over_the_target_is_told_from_a_crossing() -> None:
    interval = Parameter("T", 700)
    law = PeriodicTest("1e-5", interval, interval, MissionTime())
    leap = meets(solve(one("or", BasicEvent("a", expression=law), time=8760)), "T", "1e-3")
    assert leap.jump and min(leap.top_low, leap.top_high) < 1e-10 and max(leap.top_low, leap.top_high) > 4e-3
    assert not meets(solve(bridge()), "rate", "1e-3").jump


@pytest.mark.parametrize("beta", ["0.1", "0"])
def test_a_target_met_at_the_end_of_the_range_is_found_there(beta: str) -> None:
    """At beta = 0 two parts fail together with q squared."""
    share, q, others = Parameter("beta", beta), Parameter("q", "1e-3"), Parameter("one", 1)
    single = (others - share) * q
    events = (
        BasicEvent("common", expression=share * q),
        BasicEvent("b", expression=single),
        BasicEvent("c", expression=single),
    )
    gates = (Gate("top", "or", ("common", "both")), Gate("both", "and", ("b", "c")))
    found = meets(solve(FaultTree("t", "top", gates, events)), "beta", "1e-6")
    assert (found.low, found.high, found.exact, found.others_possible) == (0, 0, True, True)


def test_a_target_at_the_end_of_the_range_of_an_event() -> None:
    events = [BasicEvent(name, Fraction("0.1")) for name in "abc"]
    none, all_of = (meets(solve(one("and", *events)), "a", target) for target in (0, "0.01"))
    assert (none.low, none.high, none.exact, none.others_possible) == (0, 0, True, False)
    assert none.top_low == none.top_high == 0
    assert (all_of.low, all_of.high) == (1, 1)


def test_a_target_that_holds_already_is_met_at_the_present_value() -> None:
    """An exclusive or with a fair coin is fair whatever the other input."""
    tree = one("xor", BasicEvent("a", Fraction("0.3")), BasicEvent("b", Fraction("0.5")))
    found = meets(solve(tree), "a", "0.5")
    assert found.low == found.high == 0.3 and found.exact and found.others_possible
    assert not meets(solve(tree), "b", "0.3").others_possible


def test_a_target_met_twice_says_that_there_may_be_others() -> None:
    p = Parameter("p", "0.3")
    gates = (Gate("top", "and", ("a", "not b")), Gate("not b", "not", ("b",)))
    events = (BasicEvent("a", expression=p), BasicEvent("b", expression=p))
    found = meets(solve(FaultTree("t", "top", gates, events)), "p", "0.2")  # p (1 - p): at 0.2764 and 0.7236
    assert found.high < 0.3 and found.others_possible
    assert meets(solve(one("or", *events)), "p", "0.2").others_possible  # a polynomial: not known to be monotone
    alone = one("and", BasicEvent("a", expression=p), BasicEvent("b", Fraction("0.5")))
    assert not meets(solve(alone), "p", "0.2").others_possible


def test_the_search_for_an_event_with_a_rate_starts_at_its_present_probability() -> None:
    """Seen by a target that holds already: nothing else than the present value is tried."""
    event = BasicEvent("a", rate_per_hour=Fraction("1e-3"))
    solution = solve(one("or", event, time=100))
    chance = solution.tree.events[0].chance
    assert chance is not None
    found = meets(solution, "a", Fraction(chance[0]))
    assert found.low == found.high == chance[0]


def test_one_name_for_a_parameter_and_an_event() -> None:
    b = Parameter("b", "0.1")
    solution = solve(one("or", BasicEvent("a", expression=b), BasicEvent("b", Fraction("0.25"))))
    found = {(each.name, each.kind): each for each in derivatives(solution)}
    assert {key: each.derivative for key, each in found.items()} == pytest.approx(
        {("b", "parameter"): 0.75, ("a", "event"): 0.75, ("b", "event"): 0.9}
    )
    assert found["b", "event"].value == 0.25 and found["b", "parameter"].value == 0.1
    for run in (lambda: meets(solution, "b", "0.3"), lambda: tornado(solution, {"b": (0, 1)})):
        with pytest.raises(TreeError, match='write "parameter:b" or "event:b"'):
            run()
    as_event, as_parameter = (meets(solution, f"{kind}:b", "0.28") for kind in ("event", "parameter"))
    assert as_event.kind == "event" and as_event.low == pytest.approx(0.2)  # 1 - 0.9 (1 - b)
    assert as_parameter.kind == "parameter" and as_parameter.low == pytest.approx(0.04)  # 1 - 0.75 (1 - b)
    bars = {bar.name: bar for bar in tornado(solution, {"event:b": (0, 1), "parameter:b": (0, "0.5")})}
    assert (bars["event:b"].top_low, bars["event:b"].top_high) == pytest.approx((0.1, 1))
    assert (bars["parameter:b"].top_low, bars["parameter:b"].top_high) == pytest.approx((0.25, 0.625))
    with pytest.raises(TreeError, match='"event:c" is neither'):
        meets(solution, "event:c", "0.3")
