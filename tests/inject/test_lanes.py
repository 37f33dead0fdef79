"""The lanes count what a run of the same fault on the Python reading counts, masked or built in, in steps or frames."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, cast

import pytest

from safety.faults import (
    ANY_TIME,
    INTERMITTENT,
    TRANSIENT,
    Fault,
    Kind,
    byzantine,
    delayed,
    extra,
    flip,
    frozen,
    missing,
    open_circuit,
    stuck,
)  # fmt: skip
from safety.inject import Campaign, CampaignError, Group
from safety.inject import masks as masks_module
from safety.inject.engine import Batch, Outcome
from safety.inject.lanes import Chunk, LaneEngine
from safety.inject.running import HEALTHY, outcome, run_again
from safety.system import Clock, State, System
from safety.terms import UInt
from safety.terms.graph import BIT, node, uint, variable

Make = Callable[..., Campaign]
Seen = tuple[dict[str, list[int]], dict[str, int]]


def lanes(campaign: Campaign, order: list[int] | None = None) -> dict[str, Seen]:
    """What is seen of every injection (and of the fault-free run) on the lanes, in columns of some order."""
    engine, batch = LaneEngine(campaign.variant(0).task, most_lanes=7), campaign.space.batch(0, len(campaign.space))
    order = order or list(range(batch.runs))
    found = engine.run(Batch(*(array[:, order] for array in (batch.atoms, batch.first, batch.end))))
    names = [campaign.space.injection(number).id for number in order]
    whole = {name: seen(found, column) for column, name in enumerate(names)}
    return whole | {HEALTHY.id: seen(engine.golden, 0)}


def python(campaign: Campaign) -> dict[str, Seen]:
    """The same, one run after the other on the Python reading."""
    return {
        injection.id: seen(outcome(campaign, run_again(campaign, injection)), 0)
        for injection in (HEALTHY, *campaign.space.injections)
    }


def seen(found: Outcome, column: int) -> Seen:
    """Counts by block of what is counted, and the first true frame of what is watched."""
    counts = {name: array[:, column].tolist() for name, array in found.counts.items()}
    return counts, {name: int(array[column]) for name, array in found.first.items()}


def chunks(campaign: Campaign) -> list[Chunk]:
    """What runs side by side."""
    engine, batch = LaneEngine(campaign.variant(0).task), campaign.space.batch(0, len(campaign.space))
    return list(engine._chunks(batch, engine._built_in(batch)))


def built_in(kind: Kind) -> Kind:
    """The same kind in a form that has no mask: it carries a register that nothing reads."""

    def effect(seat: Any, healthy: Any) -> Any:
        seat.register("unread", BIT, False)
        return kind.effect(seat, healthy)

    return replace(kind, effect=effect)


OBSERVED: dict[str, Any] = {"lit": "lit", "alarm": "alarm"}
WATCHED = {"alarm": "alarm", "lit for long": lambda wires: wires.lasting(wires["lit"], 9), "dark": lambda w: ~w["lit"]}


def random_faults(seed: int, ticks: int, aligned: int = 1) -> Iterator[Fault]:
    """Faults of every kind at random points, bits and times."""
    pick = random.Random(seed)
    for number in range(30):
        word = pick.choice(["count", "sum", "still"])
        wire = pick.choice(["run", "alarm", "lit"])
        bit = pick.choice([None, 0, 1, 2])
        kind, points = pick.choice(
            [
                (stuck(pick.randrange(2), bit), [word]),
                (flip(bit), [word]),
                (stuck(pick.randrange(2)), [wire, "alarm"]),
                (open_circuit(), [wire]),
                (flip(), [wire]),
                (frozen(), [pick.choice([word, wire])]),
                (delayed(pick.randrange(1, 4)), [pick.choice([word, wire])]),
                (missing(pick.randrange(1, 4)), [wire]),
                (extra(), [wire]),
                (byzantine(), [wire, word]),
            ]
        )
        at = pick.randrange(ticks // aligned) * aligned
        when = [{}, {"onset": ANY_TIME, "at": at}]
        for onset in (TRANSIENT, INTERMITTENT):
            when.append({"onset": onset, "at": at, "ticks": pick.randrange(1, 6) * aligned})
        yield Fault(kind, points, name=f"{number} {kind}", **pick.choice(when))  # type: ignore[arg-type]


@pytest.mark.parametrize("seed", range(4))
def test_every_kind_counts_the_same_on_lanes_and_in_python(campaign: Make, seed: int) -> None:
    declared = campaign(
        faults=list(random_faults(seed, 80)), run_in=16, start={"count": 5}, observe=OBSERVED, watch=WATCHED
    )
    assert lanes(declared) == python(declared)


@pytest.mark.parametrize("seed", [5, 6])
def test_pairs_count_the_same_on_lanes_and_in_python(campaign: Make, seed: int) -> None:
    declared = campaign(faults=list(random_faults(seed, 96)), order=2, sample=40, seed=seed)
    assert lanes(declared) == python(declared)


def test_the_masked_form_is_the_built_in_form(campaign: Make) -> None:
    masked = campaign()
    faults = [f for injection in masked.space.injections for f in injection.faults]
    other = campaign(faults=[replace(f, kind=built_in(f.kind)) for f in faults])
    assert not any(chunk.slots for chunk in chunks(masked))
    assert all(chunk.slots for chunk in chunks(other))
    assert lanes(masked) == lanes(other) == python(masked)


def test_faults_at_one_point_act_in_their_order_whatever_the_order_of_the_columns(campaign: Make) -> None:
    kinds = [missing(1), stuck(1), built_in(flip()), flip(), frozen()]
    faults = [Fault(kind, ["lit"], name=str(n)) for n, kind in enumerate(kinds)]
    for order in (2, 3):
        declared = campaign(faults=faults, order=order)
        assert lanes(declared) == lanes(declared, [*range(len(declared.space))][::-1]) == python(declared)


def test_masked_and_built_in_faults_run_side_by_side(campaign: Make) -> None:
    declared = campaign(
        faults=[Fault(stuck(1), ["lit"]), Fault(frozen(), ["still"]), Fault(stuck(0), ["alarm"])], order=2
    )
    assert [(chunk.columns.tolist(), chunk.slots) for chunk in chunks(declared)] == [
        ([0, 2, 1], ((0, 1), (1, 1))),
    ]
    assert lanes(declared) == python(declared)


@pytest.mark.parametrize("seed", [8, 9])
def test_frames_of_some_steps_count_the_same(campaign: Make, seed: int) -> None:
    declared = campaign(
        faults=list(random_faults(seed, 96, aligned=4)), steps_per_frame=4, run_in=8, measured=16, block=4,
        stimulus=lambda frame: {"run": True},
    )  # fmt: skip
    assert lanes(declared) == python(declared)


def test_values_of_a_byzantine_fault_follow_its_list(campaign: Make) -> None:
    declared = campaign(faults=[Fault(byzantine(), ["sum"], values={"sum": [3, 9, 1, 15, 8]})], run_in=0)
    assert lanes(declared) == python(declared)


def test_a_wrong_mask_is_found_by_the_comparison(campaign: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    right = masks_module.mask_of
    monkeypatch.setattr(masks_module, "mask_of", lambda kind, sort: replace(right(kind, sort), turn=0))
    declared = campaign()
    assert lanes(declared) != python(declared)


def test_a_window_off_by_one_is_found_by_the_comparison(campaign: Make) -> None:
    declared = campaign(faults=[Fault(flip(), ["lit"], TRANSIENT, at=32, ticks=1)])
    late = replace(declared, run_in=33, measured=48)
    assert lanes(declared) == python(declared)
    assert lanes(late)["lit flip, transient at 32 for 1"] != python(declared)["lit flip, transient at 32 for 1"]


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        (Fault(stuck(1), ["lit"], ANY_TIME, at=96), r"begins at step 96, outside the run \(0 to 95\)"),
        (Fault(flip(), ["lit"], TRANSIENT, at=99, ticks=1), "begins at step 99"),
        (Fault(flip(), ["lti"]), "no point 'lti'; did you mean lit"),
        (Fault(missing(), ["count"]), "does not apply to count"),
    ],
)
def test_a_fault_that_cannot_be_injected_is_refused(campaign: Make, fault: Fault, message: str) -> None:
    with pytest.raises((CampaignError, TypeError), match=message):
        campaign(faults=[fault]).inject()


def test_a_fault_that_begins_inside_a_frame_is_refused(campaign: Make) -> None:
    fault = Fault(stuck(1), ["lit"], ANY_TIME, at=9)
    with pytest.raises(CampaignError, match="inside a frame of 4 steps; choose 8 or 12"):
        campaign(faults=[fault], steps_per_frame=4, measured=16, block=4, run_in=0).inject()


def test_a_broken_assumption_is_refused(campaign: Make) -> None:
    with pytest.raises(CampaignError, match=r"breaks (an|the) assumption"):
        campaign(stimulus=lambda frame: {"run": frame != 40}, wrong_side=lambda counts: False).inject()


def test_groups_keep_their_faults(campaign: Make) -> None:
    group = Group("two", [Fault(stuck(1), ["lit"]), Fault(stuck(0), ["lit"])])
    assert campaign(faults=[group]).inject().groups.keys() == {"two"}


@pytest.mark.parametrize("engine", ["lanes", "auto"])
@pytest.mark.parametrize("width", [32, 62, 63])
@pytest.mark.parametrize("operation", [UInt.__mul__, UInt.__add__])
def test_a_result_beyond_64_bits_is_that_of_the_python_reading(operation: Any, width: int, engine: str) -> None:
    a, x = variable("a", uint(width)), variable("x", uint(width))
    p = node("point", (a,), "p", a.sort)
    result = operation(cast(UInt, p), cast(UInt, x))
    high = node("point", (result > result.sort.bounds[1] // 2,), "high", BIT)
    states, points = (State(a, p, 2**width - 5),), {"p": p, "high": high}
    one = Campaign(
        id="wide", model=System("wide", Clock(event="tick"), states, {"x": x}, {"high": high}, points, {}, {}),
        faults=[Fault(stuck(0), ["p"]), Fault(flip(width - 1), ["p"])], engine=engine,
        measured=4, stimulus={"x": 2**width - 1}, observe={"high": "high"},
        wrong_side=lambda seen: seen.total("high") < seen.healthy("high"), detected=lambda seen: seen.total("high") < 0,
    )  # fmt: skip
    cells = [one.inject().cell(number) for number in range(2)]
    assert cells == [one.replay(number).cell for number in range(2)] and cells[0] == "wrong/no"
