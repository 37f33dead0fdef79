"""Claims about the position: verdicts, twins, and bugs planted in odometer, decoder and correction that they find."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Any, Self

import pytest

from models.position.correction import Ahead, Correction, Crowded, Tally, Where
from models.position.decoder import Collector, Decoder
from models.position.odometer import Fix, Mode, SpeedBounds, Speeds, step_s
from proofs import (
    position_codes,
    position_correction,
    position_drift,
    position_guard,
    position_journey,
    position_odometer,
    position_placing,
    position_reading,
)
from safety import REFUTED, Bit, Model, Real, Scenario, bit, select
from safety.exhibits import Exhibit
from safety.exhibits import declared as exhibits
from safety.prove.bounds.claims import declared
from safety.prove.claims import claim_id, registered
from safety.prove.prove import prove
from tests.proofs.verdicts import check, claims_of, without_twin
from tests.seeded.planting import planted

assert position_codes  # imported for its tables
MODULES = (
    position_correction,
    position_drift,
    position_guard,
    position_journey,
    position_odometer,
    position_placing,
    position_reading,
)
CLAIMS = {c.id: c for m in MODULES for c in claims_of(m).values()}
SLOW = {  # seconds each, or nearly the same question once more
    "position_reading.a_group_with_more_scale_error_is_accepted",
    "position_guard.a_true_group_is_collected",
    "position_guard.four_are_rejected",
    "position_odometer.inside_with_any_loss",
    "position_reading.a_group_with_more_jitter_is_read",
    "position_reading.first_slot_is_read",
    "position_reading.second_slot_is_read",
    "position_reading.third_slot_is_read",
    "position_reading.a_true_group_is_accepted_with_almost_an_eighth",
    "position_odometer.inside_in_the_variant",
    "position_odometer.speed_is_bounded_at_the_end",
    "position_odometer.interval_holds_the_train",  # in the acceptance check AS-08
}
LAWS = ("position_reading.reading", "position_reading.scale", "position_limits.", "position_drift.")


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] * (n in SLOW)) for n in CLAIMS])
def test_verdict(name: str) -> None:
    check(prove(CLAIMS[name]))


@pytest.mark.parametrize("each", [c for c in declared() if c.id.startswith(LAWS)], ids=lambda c: c.id)
def test_verdict_over_reals(each: Any) -> None:
    found = each.evaluate(20)
    assert found["verdict"] == each.expect, found["why"]
    assert len(found["agreed_by"]) >= 2 or each.expect == REFUTED


@pytest.mark.parametrize("module", MODULES, ids=lambda m: m.__name__)
def test_what_is_proved_has_a_claim_that_must_fail(module: Any) -> None:
    assert without_twin(claims_of(module)) == []


@pytest.mark.parametrize("each", [x for x in exhibits() if x.id.startswith("position_codes.")], ids=lambda x: x.id)
def test_tables_say_no_where_they_must(each: Exhibit) -> None:
    found = each.evaluate()
    assert found["as_expected"], found["note"]


# --- planted bugs ----------------------------------------------------------------------------------------------------


class FollowsTheWheel(SpeedBounds, tick_s=step_s):
    """Planted: the unsafe end of the interval, in a slide s_hi goes with the wheel."""

    def carried(self, most: Real) -> Real:
        return most


class NoScaleError(SpeedBounds, tick_s=step_s):
    """Planted: the scale error is forgotten."""

    def step(self, wheel: Real, mode: Mode, eps: Real, gain: Real, loss: Real) -> tuple[Self, Speeds]:
        return super().step(wheel, mode, eps * 0, gain, loss)


class NoGain(SpeedBounds, tick_s=step_s):
    """Planted: s_hi goes on from v_0 in a slip."""

    def step(self, wheel: Real, mode: Mode, eps: Real, gain: Real, loss: Real) -> tuple[Self, Speeds]:
        return super().step(wheel, mode, eps, gain * 0, loss)


class NoLoss(SpeedBounds, tick_s=step_s):
    """Planted: s_lo goes on from v_0 in a slip or slide."""

    def step(self, wheel: Real, mode: Mode, eps: Real, gain: Real, loss: Real) -> tuple[Self, Speeds]:
        return super().step(wheel, mode, eps, gain, loss * 0)


class ForgetsTheHit(Collector, tick_s=step_s):
    """Planted: the guard is hit without consequence."""

    def step(self, first: Real, last: Real, balise: Bit, ends: Bit, usable: Bit, window: Real) -> ForgetsTheHit:
        s = super().step(first, last, balise, ends, usable, window)
        return type(self)(
            count=s.count, hit=bit(False), a=s.a, b=s.b, c=s.c, last=s.last, since_first=s.since_first,
            since_last=s.since_last,
        )  # fmt: skip


class StopsAtFive(Collector, tick_s=step_s):
    """Planted: a sixth balise in the window is not counted."""

    def step(self, first: Real, last: Real, balise: Bit, ends: Bit, usable: Bit, window: Real) -> StopsAtFive:
        s = super().step(first, last, balise, ends, usable, window)
        return type(self)(
            count=select(s.count > 5, 5, s.count), hit=s.hit, a=s.a, b=s.b, c=s.c, last=s.last,
            since_first=s.since_first, since_last=s.since_last,
        )  # fmt: skip


class NoJitterInTheSpan(Decoder, tick_s=step_s):
    """Planted: window and span check leave no room for jitter."""

    def slack(self) -> Real:
        return 40 * self.eps


class FixedWindow(Correction, tick_s=step_s):
    """Planted: the window does not grow with the interval."""

    def window(self, width: Real) -> Real:
        return self.least


class NoJitterAfterwards(Crowded, tick_s=step_s):
    """Planted: the interval collapses to the place itself."""

    def found(self, place: Real, adopted: Bit, many: Bit, at: Where, code: Fix) -> Fix:
        return Fix(adopted | many | code.given, place, place, place)


class ThreeMissed(Tally, tick_s=step_s):
    """Planted: it takes three."""

    def step(self, fixed: Bit, by_code: Bit, unlisted: Bit, late: Ahead) -> tuple[ThreeMissed, Bit]:
        following, _ = super().step(fixed, by_code, unlisted, late)
        known = by_code | (self.known & (following.unmatched < 3) & (following.missed < 3))
        return type(self)(known=known, unmatched=following.unmatched, missed=following.missed), known


BEHIND = Scenario(7, {
    "seen.run": lambda k: (0, 5, 7, 18, 10, Fraction(1, 2), 41)[k], "seen.own": lambda k: k < 5,
    "seen.extra": lambda k: k == 5,
})  # fmt: skip
BEFORE = Scenario(7, {
    "seen.run": lambda k: (0, 10, 5, 7, 18, 10, 41)[k], "seen.extra": lambda k: k == 0,
    "seen.own": lambda k: 0 < k < 6,
})  # fmt: skip


@pytest.mark.parametrize(
    ("stated", "places", "script"),
    [
        (position_odometer.interval_holds_the_train, {"odometer.bounds": FollowsTheWheel}, None),
        (position_odometer.interval_holds_the_train, {"odometer.bounds": NoScaleError}, None),
        (position_odometer.interval_holds_the_train, {"odometer.bounds": NoGain}, None),
        (position_odometer.interval_holds_the_train, {"odometer.bounds": NoLoss}, None),
        (position_guard.one_fault_is_never_read, {"decoder.group": ForgetsTheHit}, BEFORE),
        (position_guard.extra_near_the_group_is_rejected, {"decoder.group": StopsAtFive}, BEHIND),
        (position_reading.a_true_group_is_accepted, {"decoder": NoJitterInTheSpan}, None),
        (position_correction.a_listed_balise_is_matched, {"correction": FixedWindow}, None),
        (position_correction.a_match_is_right_while_the_interval_holds, {"correction": NoJitterAfterwards}, None),
        (position_correction.two_in_succession_make_it_unknown, {"correction.tally": ThreeMissed}, None),
    ],
    ids=lambda x: getattr(x, "__name__", None) or (next(iter(x.values())).__name__ if isinstance(x, dict) else "run"),
)
def test_a_planted_bug_is_found(
    stated: Callable[..., Any], places: Mapping[str, type[Model]], script: Scenario | None
) -> None:
    healthy = next(c for c in registered() if c.id == claim_id(stated))
    wrong = planted(healthy.model, places)
    found = prove(replace(healthy, model=wrong, scenario=script, expect=REFUTED, symbolic=(), steps=8))
    assert found.verdict == REFUTED and found.counterexample is not None
