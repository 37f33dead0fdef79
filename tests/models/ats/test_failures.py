"""The component table of ATS-SP and radio control: its rows, what injection finds of each, and what the map finds."""

from __future__ import annotations

from typing import Any

import pytest

from models.ats.failures import CODE, CROSSING, DUAL, RADIO, STRETCH, table
from models.ats.stretch import AT_REST, LINE, Mapped, Stretch
from proofs import ats_campaign, ats_parts, ats_rates, dual_processor_hazards, radio_campaign, radio_monte_carlo
from safety import Fault, run
from safety.exhibits import declared as exhibits
from safety.inject import Campaign
from safety.inject.campaign import changed
from safety.rates.claims import declared

TABLE = """
signal balise | missing / detuned | D
signal balise | contact welded | D
signal balise | contact open | S
release balise | false proceed | D
release balise | missing | S
reference balise | missing | S
reference balise | extra | S
reference balise | both | D
branch balise | missing | D
on-board coil, oscillation unit | silent | D
on-board coil, oscillation unit | drift | D
on-board coil, oscillation unit | false shift | S
speed generator | pulse loss | D
speed generator | extra pulses | S
wheel | worn but not set | S
wheel | larger than set | D
wheel-rail | slide | D
wheel-rail | slip | S
wheel-rail | creep | D
track receiver | dead | S
track receiver | phase inverted | D
track receiver | cross-talk | D
line data ROM/IC card | wrong entry | D
line data ROM/IC card | stale edition | D
line data ROM/IC card | bit error | S
processor | single fault | S
processor | common fault | D
comparator | stuck equal | D
comparator | stuck unequal | S
clock, supply | loss | S
clock, supply | brown-out | S
I/O unit, brake relay | stuck energised | D
I/O unit, brake relay | open | S
brake | low force, low adhesion | D
display | wrong / dead | N
timetable, loop coil | wrong | D
timetable, loop coil | dead | S
radio (ground, train) | loss | S
radio (ground, train) | delay | S
radio (ground, train) | replay | D
radio (ground, train) | corruption | S
ground computer | wrong order of trains | D
ground computer | lost train | D
train integrity | parted train reported whole | D
"""
FIGURES = [
    r
    for r in declared()
    if r.id in {"ats.wrong-side", "ats.wrong-side.mapped", "radio.wrong-side", "ats.top-event", "radio.top-event"}
]
PARTS = (*ats_campaign.ON_PARTS, radio_campaign.running, radio_campaign.parting)


DIFFERENT = {"comparator: stuck equal": "N", "radio (ground, train): replay": "S"}  # from the table's D


def cells(campaigns: tuple[Campaign, ...]) -> dict[str, str]:
    """The direction that injection finds of each row."""
    return {name: found.direction for name, found in ats_parts.findings(campaigns).items()}


def told(*benches: str) -> dict[str, str]:
    return {mode.name: DIFFERENT.get(mode.name, mode.direction) for mode in table() if mode.bench in benches}


def test_list_is_the_table_row_by_row() -> None:
    rows = [tuple(line.split(" | ")) for line in TABLE.strip().splitlines()]
    assert [(mode.component, mode.mode, mode.direction) for mode in table()] == rows


def test_every_row_is_injected_and_has_an_invented_rate() -> None:
    assert all(mode.faults and mode.fit > 0 for mode in table())
    assert {mode.bench for mode in table()} == {STRETCH, CODE, DUAL, CROSSING, RADIO}


def test_a_direction_that_differs_from_the_table_says_why() -> None:
    assert {mode.name for mode in table() if mode.why} == set(DIFFERENT)
    assert all(mode.direction == "D" for mode in table() if mode.why)


def test_faults_of_a_row_are_told_apart() -> None:
    for mode in table():
        assert len({fault.name for fault in mode.injected}) == len(mode.injected), mode.name


def test_rows_that_may_strike_at_any_time_are_injected_more_than_once() -> None:
    """What the table calls restrictive or what needs a certain onset to be dangerous has others."""
    onsets = {mode.name: len(mode.injected) for mode in table()}
    axle = [mode for mode in table() if mode.component in ("speed generator", "wheel", "wheel-rail")]
    assert all(onsets[mode.name] >= 2 for mode in axle)
    assert onsets["on-board coil, oscillation unit: silent"] == 3


def small(*faults: Fault) -> Campaign:
    """Some faults on the ride towards the signal at stop."""
    return changed(ats_campaign.at_stop, faults=list(faults), expect={})


@pytest.mark.slow
def test_onset_and_size_decide_what_injection_finds() -> None:
    """Each of these rows is without effect in one injection and wrong-side in another: one alone would hide it."""
    rows = {mode.name: mode for mode in table()}
    for name in (
        "on-board coil, oscillation unit: silent",
        "speed generator: pulse loss",
        "wheel: larger than set",
        "wheel-rail: slide",
        "wheel-rail: creep",
    ):
        found = [cell for _, cell in small(*rows[name].injected).inject().injections()]
        assert {"wrong/no", "neutral/no"} == set(found), name
        assert found[0] == "neutral/no"


@pytest.mark.slow
def test_campaigns_find_what_they_state() -> None:
    for campaign in (*ats_parts.ALL, *ats_campaign.MAPPED_ON_THE_STRETCH):
        assert not campaign.inject().surprises(), campaign.id


@pytest.mark.slow
def test_exhibit_shows_every_row_and_the_two_that_differ() -> None:
    shown = next(e for e in exhibits() if e.id == "ats.component-table").evaluate()
    assert shown["as_expected"]
    assert len(shown["rows"]) == len(table())


def test_rows_of_single_parts_and_of_radio_have_the_direction_stated() -> None:
    assert cells(PARTS) == told(CODE, DUAL, CROSSING, RADIO)


@pytest.mark.slow
def test_rows_of_the_stretch_have_the_direction_stated() -> None:
    assert cells(ats_campaign.ON_THE_STRETCH) == told(STRETCH)


@pytest.mark.slow
def test_single_missing_balises_are_found_with_the_map_only() -> None:
    """Map-detectable: signal and branch balise, the silent coil; nothing else of the wrong-side rows is."""
    plain, mapped = cells(ats_campaign.ON_THE_STRETCH), cells(ats_campaign.MAPPED_ON_THE_STRETCH)
    wrong, left = ({name for name, d in found.items() if d == "D"} for found in (plain, mapped))
    assert wrong - left == set(ats_parts.MAPPED)
    assert left < wrong


def ride(model: type[Stretch], row: Any, steps: int) -> dict[str, list[Any]]:
    seen = run(model, row, steps=steps, settings=LINE, start=AT_REST, keep=("passed", "ordered", "head"))
    return {name: seen[name] for name in ("passed", "ordered", "head")}


@pytest.mark.parametrize("model", [Stretch, Mapped])
def test_healthy_train_stops_before_the_signal_and_does_not_brake_where_it_is_clear(model: type[Stretch]) -> None:
    stopped = ride(model, ats_campaign.AT_STOP, 800)
    assert not any(stopped["passed"])
    assert 1560 < stopped["head"][-1] < 1600
    assert not any(ride(model, ats_campaign.IS_CLEAR, 500)["ordered"])


def test_the_pairs_are_those_that_are_proved() -> None:
    assert [len(pair) for pair in ats_parts.PAIRS] == [2]
    assert ("processor B broken", "comparator says equal") in dual_processor_hazards.PAIRS


@pytest.mark.slow
@pytest.mark.parametrize("figure", FIGURES, ids=lambda r: r.id)
def test_rates_agree_by_two_routes(figure: Any) -> None:
    entry = figure.evaluate()
    assert len(entry["agreed_by"]) == 2
    assert entry["assumed"]


def test_five_figures_are_declared() -> None:
    assert len(FIGURES) == 5
    assert ats_rates.PARTS.source == "A"


def test_sampled_messages_are_bounded_exactly() -> None:
    """No hit in n: the greatest share p has (1 - p)^n = (1 - 0.99)/2, two-sided; sampled, not exhaustive."""
    low, high = radio_monte_carlo.bounds()
    assert low == 0
    assert float(high) == pytest.approx(1 - 0.005 ** (1 / radio_monte_carlo.MISSIONS), abs=1e-8)
