"""Trees from cut sets: probability and bounds, also where the list of cut sets is not complete."""

import math
from collections.abc import Callable
from fractions import Fraction
from itertools import combinations, product
from typing import Any

import pytest

from safety.faults import every, stuck
from safety.model import Model, point, power_up
from safety.prove.hazards import CANDIDATE, CONFIRMED, CutSet, CutSets, Hazard, hazard, hazards
from safety.report.standing import standing
from safety.terms import U1, Bit, all_of, any_of
from safety.trees import Gate
from safety.trees.from_model import beyond, completeness, told, tree_entry, tree_from_model

NAMES = [f"{wire} stuck-at-1" for wire in "abc"]
RATES = dict(zip(NAMES, ("1e-4", "2e-4", "3e-4"), strict=True))
CHANCES = {name: -math.expm1(-float(rate) * 100) for name, rate in RATES.items()}


class Wires(Model, tick_s="1"):
    """Three wires."""

    n: U1 = power_up(0)

    def step(self, x: Bit) -> tuple["Wires", Bit]:
        return Wires(n=self.n), all_of(*(point(wire, x) for wire in "abc"))


class Channel(Model, tick_s="1"):
    """A wire and a relay."""

    n: U1 = power_up(0)

    def step(self, x: Bit) -> tuple["Channel", Bit]:
        return Channel(n=self.n), point("relay", point("wire", x))


class Voter(Model, tick_s="1"):
    """Two of three channels; of the class of `spare` there is but one."""

    a: Channel
    b: Channel
    c: Channel
    spare: Wires

    def step(self, x: Bit) -> tuple["Voter", Bit]:
        a, y = self.a.step(x)
        b, z = self.b.step(x)
        c, u = self.c.step(x)
        spare, _ = self.spare.step(x)
        return Voter(a=a, b=b, c=c, spare=spare), any_of(y & z, z & u, y & u)


@pytest.fixture
def declare(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Hazard]:
    monkeypatch.setattr("safety.prove.hazards._registry", {})

    def make(**more: Any) -> Hazard:
        rates = {name: (rate, "[A] guess") for name, rate in RATES.items()}

        @hazard(
            Wires,
            faults=every(stuck(1), *"abc"),
            scenarios=lambda names: [],
            **({"rates": rates, "hours": "100"} | more),
        )
        def all_high(s: Any) -> Bit:
            """All wires are high."""
            return s.out

        return hazards()[0]

    return make


def found(*sets: str, complete_to: int = 3, all_orders: bool = True, status: str = CONFIRMED, why: str = "") -> CutSets:
    return CutSets(
        "x.all_high",
        [CutSet(tuple(f"{wire} stuck-at-1" for wire in one), status) for one in sets],
        complete_to,
        all_orders,
        why,
    )


def test_a_complete_list_gives_the_probability_with_narrow_bounds(declare: Callable[..., Hazard]) -> None:
    entry = tree_entry(found("a", "bc"), declare())
    a, b, c = CHANCES.values()
    assert entry["probability"] == pytest.approx(a + (1 - a) * b * c, rel=1e-14)
    assert entry["probability_high"] - entry["probability_low"] < 1e-14
    assert entry["completeness"] == "complete at all orders over the 3 listed faults"
    assert standing("trees", entry).code == 0


def test_missing_orders_widen_the_upper_bound_to_what_they_could_add(declare: Callable[..., Hazard]) -> None:
    entry = tree_entry(found("a", complete_to=1, all_orders=False), declare())
    a, b, c = CHANCES.values()
    true_at_most = 1 - (1 - a) * (1 - b * c)
    assert entry["probability"] is None
    assert entry["probability_low"] <= a <= true_at_most <= entry["probability_high"] < a + 0.0012
    assert entry["completeness"] == "complete up to 1 faults at once, larger sets may exist"


def test_an_unfinished_list_has_no_upper_bound_and_is_undecided(declare: Callable[..., Hazard]) -> None:
    unfinished = found("a", complete_to=-1, all_orders=False, why="the solver gave no answer at order 0")
    entry = tree_entry(unfinished, declare())
    assert (entry["probability"], entry["probability_high"]) == (None, None)
    assert standing("trees", entry).code == 3
    assert completeness(unfinished, 3) == "not complete: the solver gave no answer at order 0"


def test_a_fault_without_rate_leaves_the_probability_unknown(declare: Callable[..., Hazard]) -> None:
    entry = tree_entry(found("a", "b"), declare(rates={NAMES[0]: ("1e-4", "[P] handbook")}))
    assert (entry["probability"], entry["probability_low"], entry["probability_high"]) == (None, None, None)
    assert [event.get("source") for event in entry["structure"]["basic_events"]] == ["P", None]


def test_candidates_are_counted_and_marked(declare: Callable[..., Hazard]) -> None:
    entry = tree_entry(found("a", "bc", status=CANDIDATE), declare(expect={1: 1, 2: 1}))
    assert (entry["confirmed"], entry["candidate"]) == ({}, {1: 1, 2: 1})
    assert {one["status"] for one in entry["minimal_cut_sets"]["sets"]} == {CANDIDATE}
    assert entry["as_expected"]


def test_candidates_count_above_and_not_below(declare: Callable[..., Hazard]) -> None:
    partly = found("bc")
    partly.sets.append(CutSet((NAMES[0],), CANDIDATE))
    entry = tree_entry(partly, declare())
    a, b, c = CHANCES.values()
    assert (entry["probability"], entry["minimal_cut_sets"]["count"]) == (None, 2)
    assert entry["probability_low"] == pytest.approx(b * c, rel=1e-14) and entry["probability_low"] <= b * c
    above = a + (1 - a) * b * c
    assert entry["probability_high"] == pytest.approx(above, rel=1e-14) and entry["probability_high"] >= above
    entry = tree_entry(found("a", status=CANDIDATE), declare())
    assert (entry["probability"], entry["probability_low"]) == (None, 0.0)
    assert entry["probability_high"] == pytest.approx(a, rel=1e-14)


def test_a_candidate_that_hardly_matters_leaves_the_probability_known(declare: Callable[..., Hazard]) -> None:
    rates = {name: (rate, "[A] guess") for name, rate in zip(NAMES, ("1e-4", "1e-9", "1e-9"), strict=True)}
    partly = found("a")
    partly.sets.append(CutSet(tuple(NAMES[1:]), CANDIDATE))
    entry = tree_entry(partly, declare(rates=rates))
    assert entry["probability_low"] < entry["probability"] <= entry["probability_high"]


def test_the_bounds_close_in_order_by_order(declare: Callable[..., Hazard]) -> None:
    """Three wires, of which a alone, or b and c, are a cut set: enclosed at every stage, wherever b stands."""
    a, b, c = CHANCES.values()
    truth = a + (1 - a) * b * c
    stages = [
        found(complete_to=0, all_orders=False),
        found("a", complete_to=1, all_orders=False, status=CANDIDATE),
        found("a", complete_to=1, all_orders=False),
        found("a", "bc", complete_to=2, all_orders=False),
        found("a", "bc"),
    ]
    hazard = declare()
    bounds = [(e["probability_low"], e["probability_high"]) for e in (tree_entry(stage, hazard) for stage in stages)]
    assert all(low <= truth <= high for low, high in bounds)
    widths = [high - low for low, high in bounds]
    assert widths == sorted(widths, reverse=True) and widths[0] > 0.05 and widths[-1] < 1e-14
    assert told(stages[1], hazard) == "order 1 complete, 1 cut set so far, probability 0 to 0.0111"
    assert told(found(complete_to=-1, all_orders=False), hazard) == "order -1 complete, 0 cut sets so far"


def test_a_hazard_whose_candidates_are_taken_for_sure_is_noticed(
    declare: Callable[..., Hazard], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("safety.trees.from_model.CONFIRMED", CANDIDATE)
    with pytest.raises(AssertionError):
        test_candidates_count_above_and_not_below(declare)


def test_channels_of_the_model_are_drawn_as_such(monkeypatch: pytest.MonkeyPatch) -> None:
    """Short names of like parts come with the name of their class: what fails is channel a."""
    monkeypatch.setattr("safety.prove.hazards._registry", {})
    channels = [[f"{c}.relay stuck-at-1", f"{c}.wire stuck-at-1"] for c in "abc"]
    points = [f"{c}.{point}" for c in "abc" for point in ("relay", "wire")]

    @hazard(Voter, faults=every(stuck(1), *points), scenarios=lambda names: [])
    def output(s: Any) -> Bit:
        """The output is high."""
        return s.out

    pairs = [CutSet(pair, CONFIRMED) for x, y in combinations(channels, 2) for pair in product(x, y)]
    tree = tree_from_model(CutSets("x", pairs, 6, True), hazards()[0])
    assert tree.gates[0].inputs == ("channel a fails", "channel b fails", "channel c fails")
    assert (tree.gates[0].kind, tree.gates[0].k, tree.gates[0].description) == ("vote", 2, "The output is high.")
    assert tree.gates[1] == Gate("channel a fails", "or", tuple(channels[0]))


def test_no_cut_set_is_probability_0(declare: Callable[..., Hazard]) -> None:
    entry = tree_entry(found(), declare())
    assert (entry["probability"], entry["minimal_cut_sets"]["count"]) == (0.0, 0)


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_what_lies_beyond_is_the_sum_over_all_sets_of_that_order(order: int) -> None:
    rates = [Fraction(1, 10), Fraction(1, 5), Fraction(1, 4)]
    assert beyond(rates, order) == sum((math.prod(one) for one in combinations(rates, order)), Fraction(0))
