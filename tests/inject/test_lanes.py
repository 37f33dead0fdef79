"""The lanes count what a run of the same fault on the Python reading counts, masked or built in, in steps or frames."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

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
from safety.inject.campaign import observed
from safety.inject.lanes import plan, run_batch
from safety.inject.running import HEALTHY, _counted, _Kernels, _run
from safety.terms.graph import BIT

Make = Callable[..., Campaign]


def lanes(campaign: Campaign) -> dict[str, dict[str, list[int]]]:
    """Counts of every injection (and of the fault-free run) by block, on the lanes."""
    todo = plan(campaign.system, campaign.space.injections, campaign.timing, most_lanes=7)
    kernels = _Kernels(campaign, todo)
    found: dict[str, dict[str, list[int]]] = {}
    for batch in todo.batches:
        counts = run_batch(
            kernels.of(batch), batch, campaign.space.injections, todo, campaign.inputs, campaign.timing, campaign.start,
            lambda frame: None,
        )  # fmt: skip
        names = [HEALTHY.id, *(campaign.space.injections[i].id for i in batch.positions)]
        for lane, name in enumerate(names):
            found[name] = {wire: counts[observed(wire)][:, lane].tolist() for wire in campaign.observe}
    return found


def python(campaign: Campaign) -> dict[str, dict[str, list[int]]]:
    """The same, one run after the other on the Python reading."""
    return {
        injection.id: {wire: c[:, 0].tolist() for wire, c in _counted(campaign, _run(campaign, injection, ())).items()}
        for injection in (HEALTHY, *campaign.space.injections)
    }


def built_in(kind: Kind) -> Kind:
    """The same kind in a form that has no mask: it carries a register that nothing reads."""

    def effect(seat: Any, healthy: Any) -> Any:
        seat.register("unread", BIT, False)
        return kind.effect(seat, healthy)

    return replace(kind, effect=effect)


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
    declared = campaign(faults=list(random_faults(seed, 80)), run_in=16, start={"count": 5})
    assert lanes(declared) == python(declared)


@pytest.mark.parametrize("seed", [5, 6])
def test_pairs_count_the_same_on_lanes_and_in_python(campaign: Make, seed: int) -> None:
    declared = campaign(faults=list(random_faults(seed, 96)), order=2, sample=40, seed=seed)
    assert lanes(declared) == python(declared)


def test_the_masked_form_is_the_built_in_form(campaign: Make) -> None:
    masked = campaign()
    faults = [f for injection in masked.space.injections for f in injection.faults]
    other = campaign(faults=[replace(f, kind=built_in(f.kind)) for f in faults])
    assert not any(b.built_in for b in plan(masked.system, masked.space.injections, masked.timing).batches)
    assert all(b.built_in for b in plan(other.system, other.space.injections, other.timing).batches)
    assert lanes(masked) == lanes(other) == python(masked)


def test_faults_at_one_point_act_in_their_order_whatever_the_sample(campaign: Make) -> None:
    kinds = [missing(1), stuck(1), built_in(flip()), flip(), frozen()]
    declared = campaign(faults=[Fault(kind, ["lit"], name=str(n)) for n, kind in enumerate(kinds)], order=2)
    injections = declared.space.injections
    for chosen in (injections, injections[::-1]):
        vars(declared)["space"] = replace(declared.space, injections=chosen)
        assert lanes(declared) == python(declared)


def test_masked_and_built_in_faults_share_a_batch(campaign: Make) -> None:
    declared = campaign(
        faults=[Fault(stuck(1), ["lit"]), Fault(frozen(), ["still"]), Fault(stuck(0), ["alarm"])], order=2
    )
    todo = plan(declared.system, declared.space.injections, declared.timing)
    assert [(len(b.positions), [str(f.kind) for f in b.built_in]) for b in todo.batches] == [(3, ["frozen"])]
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
        (Fault(flip(), ["lit"], TRANSIENT, at=-1, ticks=1), "begins at step -1"),
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
    with pytest.raises(CampaignError, match="breaks an assumption"):
        campaign(stimulus=lambda frame: {"run": frame != 40}, wrong_side=lambda counts: False).inject()


def test_groups_keep_their_faults(campaign: Make) -> None:
    group = Group("two", [Fault(stuck(1), ["lit"]), Fault(stuck(0), ["lit"])])
    assert campaign(faults=[group]).inject().groups.keys() == {"two"}
