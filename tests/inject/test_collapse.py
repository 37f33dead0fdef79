"""Faults that are said to come to the same do so: each rule against running everything, on random systems."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from itertools import combinations, product
from typing import Any

import numpy as np
import pytest

from safety.faults import Fault, flip, stuck
from safety.inject import Campaign, CampaignError, stuck_bits
from safety.inject import collapse as module
from safety.inject.collapse import collapse
from safety.inject.engine import NEVER, NONE, Batch, Outcome
from safety.inject.lanes import LaneEngine
from safety.inject.masks import Mask
from safety.inject.space import window
from safety.system import Clock, System
from safety.terms import implies, select, word
from safety.terms.graph import BIT, Term, describe, node, uint, variable, variables
from safety.terms.texts import compile_python
from safety.terms.values import bit
from tests.inject.random_systems import LOOKS, WIDTH, bit_faults, other_faults, random_system, task_of

Make = Callable[..., Campaign]


def runs(engine: LaneEngine, rows: list[tuple[int, ...]], order: int) -> list[bytes]:
    """What is seen of runs with these atoms, to be compared."""
    windows = [window(fault) for fault in engine.task.atoms] + [(0, NEVER)]  # the last stands for NONE
    atoms = np.array(rows, dtype=np.int32).reshape(-1, order).T
    first, end = (np.array([w[i] for w in windows], dtype=np.int32)[atoms] for i in (0, 1))
    return told(engine.run(Batch(atoms, first, end)))


def told(found: Outcome) -> list[bytes]:
    arrays = [*found.counts.values(), *(row[None] for row in found.first.values())]
    return [column.tobytes() for column in np.concatenate(arrays).T]


def wrong_classes(seed: int, order: int) -> tuple[int, Counter[str]]:
    """How many injections of a random system do not come out as what is run for them, and what was collapsed."""
    pick = random.Random(seed)
    system = random_system(pick)
    plain, others = list(bit_faults(system)), list(other_faults(pick, system))
    rows = [(place,) for place in range(len(plain) + len(others))]
    if order > 1:
        rows = [tuple(sorted(pick.sample(range(len(plain)), order))) for _ in range(700)]
        rows += [(*sorted(pick.sample(range(len(plain)), order - 1)), len(plain) + k % len(others)) for k in range(24)]
    return differing(system, [*plain, *others], rows, pick)


def differing(
    system: System, faults: list[Fault], rows: list[tuple[int, ...]], pick: random.Random
) -> tuple[int, Counter[str]]:
    engine = LaneEngine(task_of(system, faults, pick))
    led = [tuple(row) for row in collapse(system, faults, LOOKS).representatives(np.array(rows).T).T.tolist()]
    plain, collapsed = (runs(engine, each, len(rows[0])) for each in (rows, led))
    kinds = Counter("own" if a == b else "none" if NONE in b else "led" for a, b in zip(rows, led, strict=True))
    return sum(a != b for a, b in zip(plain, collapsed, strict=True)), kinds


def chains() -> System:
    """A wire through three points, and constants through points into a gate."""
    x, y = variable("x", BIT), variable("y", uint(WIDTH))
    p = node("point", (x,), "p", BIT)
    q = node("point", (p & (y < 6),), "q", BIT)
    r = node("point", (q & (y < 5),), "r", BIT)
    c, d = (node("point", (bit(True),), name, BIT) for name in "cd")
    e = node("point", (c & ~d,), "e", BIT)
    points = {str(t.attr): t for t in (p, q, r, c, d, e)}
    looks = dict(zip(LOOKS, (r, e | (y < 2)), strict=True))
    return System("chains", Clock(event="tick"), (), {"x": x, "y": y}, looks, points, {}, {})


def wrong_in_chains() -> int:
    system = chains()
    faults = list(bit_faults(system))
    return differing(system, faults, list(combinations(range(len(faults)), 2)), random.Random(1))[0]


@pytest.mark.parametrize("order", [1, 2, 3])
def test_what_is_collapsed_comes_out_as_if_it_were_run(order: int) -> None:
    found: Counter[str] = Counter()
    for seed in range(8):
        wrong, kinds = wrong_classes(seed, order)
        assert wrong == 0, (seed, order)
        found += kinds
    assert found["none"] > 20 and found["led"] > 20


# --- each rule, for all values ----------------------------------------------------------------------------------------

P, X, V, W = variable("P", BIT), variable("X", BIT), variable("V", uint(3)), variable("W", uint(3))
READERS: list[tuple[Any, Term]] = [  # what reads a place, and the place
    (node("point", (P,), "p", BIT), P), (~P, P), (P & X, P), (X & P, P), (P | X, P), (X | P, P), (P ^ X, P),
    (implies(P, X), P), (implies(X, P), P), (P.word(), P), (select(P, 0, word(1, 1)), P), (select(X, P, ~X), P),
    (V & W, V), (W | V, V), (V ^ W, V), (V & 5, V), (V ^ 7, V), (V.bit(2), V), (V.slice(1, 2), V), (V.low(2), V),
    (V.concat(W), V), (W.concat(V), V), (V.widen(5), V), (V + W, V), (V < W, V), (V.sat(2), V), (V // 2, V),
    (select(X, V, W), V), (V.int() - 1, V), (node("point", (V,), "v", uint(3)), V),
]  # fmt: skip


def shows(mask: Mask, value: int) -> int:
    return value & mask.keep ^ mask.turn


def disagreements(reader: Term, place: Term, told: Callable[..., Mask | None]) -> tuple[int, int]:
    """In how many cases a mask on the place is not what is told of it at the reader; how often something is told."""
    leaves = variables([reader])
    step = compile_python(leaves, [reader])
    top = int(place.sort.bounds[1])
    wrong = number = 0
    for mask in (Mask(keep, turn) for keep in range(top + 1) for turn in range(top + 1)):
        further = told(reader, place, mask)
        if further is None:
            continue
        number += 1
        for values in product(*([False, True] if leaf.sort == BIT else range(8) for leaf in leaves)):
            faulty = [type(v)(shows(mask, v)) if leaf is place else v for leaf, v in zip(leaves, values, strict=True)]
            wrong += step(*faulty)[0] != shows(further, step(*values)[0])
    return wrong, number


@pytest.mark.parametrize(("reader", "place"), READERS, ids=lambda term: describe(term))
def test_a_mask_is_what_is_told_of_it_further_on(reader: Term, place: Term) -> None:
    wrong, number = disagreements(reader, place, module.told)
    assert wrong == 0
    exact = {"point", "not", "bit", "slice", "concat", "cast", "and", "or", "xor", "implies", "band", "bor", "bxor"}
    word_of_wire = reader.op == "select" and [a.attr for a in reader.args[1:]] == [1, 0]
    assert bool(number) == (word_of_wire or (reader.op in exact and reader.sort.kind != "int"))


@pytest.mark.parametrize("op", sorted({reader.op for reader, _ in READERS} - {"point", "cast"}))
def test_a_wrong_rule_is_found(op: str) -> None:
    """Telling the mask as it is, which is right for another name and for the same value in a wider word only."""
    found = [disagreements(r, p, lambda reader, place, mask: mask)[0] for r, p in READERS if r.op == op]
    assert any(found)


@pytest.mark.parametrize("order", [2, 3])
def test_a_fault_in_the_zone_of_another_is_not_taken_for_apart(monkeypatch: pytest.MonkeyPatch, order: int) -> None:
    right = module.Collapse.representatives

    def careless(found: Any, members: Any) -> Any:
        return right(replace(found, apart=np.ones_like(found.apart)), members)

    monkeypatch.setattr(module.Collapse, "representatives", careless)
    assert any(wrong_classes(seed, order)[0] for seed in range(12))


def test_faults_at_one_point_keep_their_order() -> None:
    """The last of a pair at one point is what shows, whichever fault stands for it alone."""
    faults = [Fault(stuck(0), ["p"]), Fault(stuck(1), ["p"]), Fault(stuck(0), ["p"], name="again")]
    found = collapse(chains(), faults, LOOKS)
    assert found.leaders.tolist() == [0, 1, 0]
    assert found.representatives(np.array([[0, 0, 1], [1, 2, 2]])).T.tolist() == [[0, 1], [0, 2], [1, 2]]


@pytest.mark.parametrize("left_out", ["", "q", "d"])
def test_a_zone_that_lacks_a_point_is_found(monkeypatch: pytest.MonkeyPatch, left_out: str) -> None:
    right = module.Graph.end

    def less(graph: Any, at: Any) -> Any:
        end = right(graph, at)
        return replace(end, zone=end.zone - {left_out})

    monkeypatch.setattr(module.Graph, "end", less)
    assert bool(wrong_in_chains()) == bool(left_out)


def test_what_is_read_later_is_not_taken_for_unread(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "live", lambda system, roots, registers: list(roots))
    assert any(wrong_classes(seed, 1)[0] for seed in range(12))


# --- in a campaign ----------------------------------------------------------------------------------------------------


def test_a_campaign_counts_each_fault_of_a_class(campaign: Make) -> None:
    faults = [Fault(stuck(1), ["lit"]), Fault(stuck(1), ["lit"], name="again"), Fault(flip(), ["lit"])]
    declared = campaign(faults=faults)
    assert declared.collapse().leaders.tolist() == [0, 0, 2]
    found = declared.inject()
    assert (found.tally.injections, found.tally["wrong/no"]) == (3, 2)
    assert found.to_json()["collapsed"] == {"single_faults": 3, "run": 2, "cannot_show": 0}
    assert [declared.replay(one.id).cell for one in declared.space.injections] == [
        cell for _, cell in found.injections()
    ]


@pytest.mark.parametrize("sample", [None, 7])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_the_audit_agrees_and_so_does_no_collapsing(campaign: Make, order: int, sample: int | None) -> None:
    faults = [*stuck_bits("sum", "lit", "alarm")(campaign().system), Fault(stuck(1), ["lit"], name="again")]
    found = [
        campaign(faults=faults, order=order, sample=sample, **how).inject().judged.cells.tolist()
        for how in ({}, {"audit": True}, {"collapsing": False})
    ]
    assert found[0] == found[1] == found[2]


def test_the_fault_free_run_is_judged_even_where_nothing_shows(campaign: Make) -> None:
    idle = {"constant": {"run": True}, "stimulus": {}, "faults": [Fault(stuck(1), ["run"])]}
    assert campaign(**idle).inject().tally["neutral/no"] == 1
    with pytest.raises(CampaignError, match="the fault-free run is judged neutral/yes"):
        campaign(**idle, detected=lambda counts: True).inject()


def test_the_audit_finds_a_wrong_class(campaign: Make) -> None:
    declared = campaign(audit=True)
    right = declared.collapse()
    declared._collapses[0] = replace(right, leaders=np.where(right.leaders == 5, 0, right.leaders))
    with pytest.raises(
        CampaignError, match=r"collapsing is wrong for 1 of 14 injections: count stuck-at-1 bit 2 comes"
    ):
        declared.inject()


def test_ranges_do_not_change_the_result(campaign: Make) -> None:
    faults = [*stuck_bits("sum", "lit")(campaign().system), *stuck_bits("alarm", "run")(campaign().system)]
    declared = campaign(faults=faults, order=2)
    whole = declared.judged(0, len(declared.space)).cells.tolist()
    parts = [declared.judged(low, min(low + 7, len(whole))).cells.tolist() for low in range(0, len(whole), 7)]
    assert [cell for part in parts for cell in part] == whole
