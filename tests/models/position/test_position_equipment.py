"""Odometer, decoder and correction as equipment: the public checks AS-05 to AS-09 and refusals, by running them."""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from functools import cache

import pytest

from models.position.code import Code, mirror, substituted
from models.position.code_sets import TURNED, bose
from models.position.correction import Correction
from models.position.decoder import Decoder, Thinned, Unguarded, span_tolerance, window
from models.position.locator import Locator, UnstampedLocator
from models.position.odometer import PI, PULSES, Odometer, SpeedGenerator, step_s
from models.position.on_slots import group, read
from models.position.placing import CodeReader, Group, Placing
from models.position.ride import Ride
from proofs import position_drift, position_limits, position_odometer, position_reading
from safety import PROVED, Model, ModelError
from safety.prove.bounds.claims import declared
from safety.prove.claims import registered
from safety.prove.prove import prove
from safety.prove.weakest import declared as syntheses
from safety.prove.weakest_search import find
from safety.system import System
from safety.trace import run
from safety.tracing import trace

CYCLE, SLIDE_S = Fraction(1, 10), 3
STEADY = {"fix.given": False, "fix.low": 0, "fix.place": 0, "fix.high": 0, "at.spins": False}
Read = list[tuple[Fraction, Code]]


# --- AS-05: limits ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "percent"),
    [("gaps_at_005", "1.0811"), ("gaps_at_010", "0.8108"), ("gaps_at_020", "0.2703"), ("cumulative_at_010", "0.7692")],
)
def test_as_05_limits_of_plain_reading(name: str, percent: str) -> None:
    found = find(next(s for s in syntheses() if s.id == f"{position_limits.__name__.split('.')[-1]}.{name}"))
    assert round(float(found.safe_from) * 100, 4) == float(percent)
    assert found.refuted_at is not None and 0 < found.refuted_at - found.safe_from <= position_limits.PPM


def test_as_05_error_of_a_normalised_slot() -> None:
    bracket = next(c for c in declared() if c.id.endswith("error_of_a_slot")).evaluate(20)
    assert bracket["verdict"] == PROVED
    assert bracket["bracket"]["low"]["exact"] == bracket["bracket"]["high"]["exact"] == "1/5"


# --- AS-06: the decoder ----------------------------------------------------------------------------------------------


@cache
def system(model: type[Model]) -> System:
    """Traced once."""
    return trace(model)


def readings(model: type[Model], places: Sequence[Fraction | int], scale: Fraction = Fraction(1)) -> Read:
    """What is accepted of balises at these places, counted by a scale: origin from the first place, and code."""
    runs = [b - a for a, b in zip([places[0], *places], places, strict=False)]
    rows = [{"run": scale * way, "balise": True, "reverses": False, "slips": False} for way in runs]
    seen = run(system(model), [*rows, {"run": 90, "balise": False, "reverses": False, "slips": False}])
    ends = [*(scale * (place - places[0]) for place in places), scale * (places[-1] - places[0]) + 90]
    found = []
    for k, end in enumerate(ends):
        if seen["accepted"][k]:
            code = tuple(seen[name][k] for name in "pqr")
            found.append((end - seen["origin"][k], code))
    return found  # type: ignore[return-value]


@pytest.mark.parametrize("scale", [Fraction("0.99"), Fraction(1), Fraction("1.01")])
@pytest.mark.parametrize("code", [(5, 12, 30), (1, 2, 3), (37, 38, 39), (1, 20, 39)])
def test_a_group_is_read(code: Code, scale: Fraction) -> None:
    assert readings(Decoder, (0, *code, 40), scale) == [(0, code)]


def test_as_06_four_six_and_a_span_of_39_are_rejected() -> None:
    assert readings(Decoder, (0, 5, 12, 40)) == []
    assert readings(Decoder, (0, 5, 12, 20, 30, 40)) == []
    assert readings(Decoder, (0, 5, 12, 30, 39)) == []


class Installed(Decoder, tick_s=step_s):
    """The decoder of a line on which only some codes are installed, {5, 17, 30} not among them."""

    codes = frozenset({(5, 12, 30), (7, 20, 31)})


def test_as_06_loss_and_insertion() -> None:
    """{5, 12, 30} with 17 instead of 12: the plain decoder reads {5, 17, 30}, the line data do not know it."""
    assert readings(Decoder, (0, 5, 17, 30, 40)) == [(0, (5, 17, 30))]
    assert readings(Installed, (0, 5, 17, 30, 40)) == []
    assert readings(Installed, (0, 5, 12, 30, 40)) == [(0, (5, 12, 30))]
    assert readings(Thinned, (0, 5, 17, 30, 40)) == []
    for code in sorted(bose(TURNED))[::60]:
        assert readings(Thinned, (0, *code, 40)) == [(0, code)]
        p, q, r = next(substituted(code))
        assert readings(Decoder, (0, p, q, r, 40)) and not readings(Thinned, (0, p, q, r, 40))


def test_as_06_extra_ten_slots_before() -> None:
    places = (-10, 0, 5, 12, 30, 40)
    assert readings(Decoder, places) == []
    assert readings(Unguarded, places) == [(0, (10, 15, 22))]


def test_an_extra_one_beyond_the_guard_does_no_harm() -> None:
    far = -window(Fraction(1, 10), Fraction(1, 100)) - Fraction(1, 100)
    assert readings(Decoder, (far, 0, 5, 12, 30, 40)) == [(-far, (5, 12, 30))]


@pytest.mark.parametrize("guarded", [True, False])
def test_equipment_and_reading_on_slots_agree(guarded: bool) -> None:
    """Random groups with one or two faults."""
    chance = random.Random(6)
    for _ in range(40):
        code: Code = tuple(sorted(chance.sample(range(1, 40), 3)))  # type: ignore[assignment]
        lost = chance.choice([None, 0, *code, 40])
        free = [n for n in range(-41, 82) if n not in (0, *code, 40)]
        places = group(code, chance.choice([None, code[2] - 40, *chance.sample(free, 3)]), lost)
        ways = [n for n in range(places.bit_length()) if places >> n & 1]
        seen = readings(Decoder if guarded else Unguarded, ways)
        assert [(ways[0] - 80 + origin, c) for origin, c in seen] == list(read(places, guarded))


@pytest.mark.parametrize("flag", ["reverses", "slips"])
def test_reversal_or_slip_within_a_group_rejects_it(flag: str) -> None:
    rows = [{"run": way, "balise": True, "reverses": False, "slips": False} for way in (0, 5, 7, 18, 10)]
    rows[2][flag] = True
    seen = run(Decoder, [*rows, {"run": 90, "balise": False, "reverses": False, "slips": False}])
    assert not any(seen["accepted"]) and seen["rejected"][2]


# --- AS-07 to AS-09: the odometer ------------------------------------------------------------------------------------


def slide(braking: str) -> tuple[Fraction, Fraction, Fraction, Fraction]:
    """A wheel locked for 3 s from 20 m/s at 0.8 m/s^2: the way, and how far off count, estimate and s_hi are.

    The train has reached 20 m/s braking by so much in the cycle before: that is what the estimate goes on with.
    """
    trend, true = Fraction(braking) * CYCLE, Fraction("0.8")
    speeds = [*(CYCLE * n for n in range(1, 201)), 20 + trend, Fraction(20)]
    cycles = round(SLIDE_S / CYCLE)
    later = [20 - true * CYCLE * (2 * n + 1) / 2 for n in range(cycles)]
    rows = [
        {**STEADY, "at.gain": (now - before) / CYCLE, "at.wheel": now, "at.slides": False}
        for before, now in zip([Fraction(0), *speeds], speeds, strict=False)
    ]
    rows += [
        {**STEADY, "at.gain": (now - before) / CYCLE, "at.wheel": 0, "at.slides": True}
        for before, now in zip([Fraction(20), *later], later, strict=False)
    ]
    seen = run(Ride, rows, settings={"odometer.eps": 0})
    there, counted = seen["there"], seen["counted"]
    guess, high = seen["odometer.guess"], seen["odometer.high"]
    began = len(speeds) - 1
    return (
        there[-1] - there[began],
        counted[-1] - there[-1],
        guess[-1] - there[-1],
        high[-1] - there[-1] - (high[began] - there[began]),
    )


def test_as_07_slide_reference() -> None:
    way, count, estimate, high = slide("0.6")
    assert (way, count, estimate, high) == tuple(map(Fraction, ("56.4", "-56.4", "0.9", "3.6")))
    assert slide("1.0")[2] == Fraction("-0.9")


def test_a_slide_from_traction_is_taken_to_hold_the_speed() -> None:
    """b_ref is never below 0: no gain of speed is carried into a slide."""
    speeds = [CYCLE * n for n in range(1, 21)]
    rows = [{**STEADY, "at.gain": 1, "at.wheel": now, "at.slides": False} for now in speeds]
    rows += [{**STEADY, "at.gain": 0, "at.wheel": 0, "at.slides": True}] * 3
    seen = run(Ride, rows)
    assert seen["odometer.watch.guess"][-1] == 2 and seen["odometer.watch.sliding"][-1]


def test_as_08_one_slide_by_proof() -> None:
    """For ever, and for all parameters: a slide with any braking up to b_hi is one of the runs."""
    claim = next(c for c in registered() if c.id == "position_odometer.interval_holds_the_train")
    found = prove(claim)
    assert found.verdict == PROVED and found.agreed_by == ["z3", "cvc5"]


def test_as_08_random_slides() -> None:
    """Braking anything from 0 to 1.3 m/s^2, the wheel at any lower speed, then gripping."""
    chance, slides = random.Random(8), 0
    for _ in range(30):
        speed, rows, sliding = Fraction(0), [], range(chance.randint(40, 60), chance.randint(70, 90))
        for k in range(120):
            gain = (
                Fraction(chance.randint(0, 100), 100) if k < sliding.start else -Fraction(chance.randint(0, 130), 100)
            )
            now = max(Fraction(0), speed + gain * CYCLE)
            off = Fraction(chance.randint(-5, 5), 1000)
            wheel = now * Fraction(chance.randint(0, 60), 100) if k in sliding else now * (1 + off)
            rows.append({**STEADY, "at.gain": gain, "at.wheel": wheel, "at.slides": k in sliding})
            speed = now
        seen = run(Ride, rows)
        slips, slid = seen["odometer.watch.slipping"], seen["odometer.watch.sliding"]
        if any(k in sliding and not slid[k] for k in range(120)) or any(slips):
            continue  # not detected, or recovered while it still slid: a premise is broken
        slides += 1
        low, there, high = seen["odometer.low"], seen["there"], seen["odometer.high"]
        assert all(a <= b <= c for a, b, c in zip(low, there, high, strict=True))
    assert slides >= 10


def counted(pulses: int, diameter: str) -> Fraction:
    """Way that the equipment counts for so many pulses, m."""
    seen = run(SpeedGenerator, [{"pulses": pulses}], settings={"diameter": Fraction(diameter)})
    return Fraction(seen["out"][0])


def test_as_09_wheel_set_wrongly() -> None:
    """True diameter against the one set, 860 mm: the true way is what a set of that diameter would count."""
    assert round(float(counted(60, "0.86") / 60), 7) == 0.0450295
    larger, smaller = (counted(1000, true) / counted(1000, "0.86") for true in ("0.91", "0.84"))
    assert round(float(1000 * (larger - 1)), 2) == 58.14  # m that a counted km falls short
    assert round(float(1000 * (1 / smaller - 1)), 2) == 23.81  # m too many in a true km
    assert larger > 1 > smaller


def test_pulses_have_to_be_timed() -> None:
    """One pulse more in a cycle is 4.5 m/s^2: counted by the cycle, it would be taken for a slip."""
    pulse = Fraction("0.86") * PI / PULSES
    assert pulse / CYCLE / CYCLE > 3 * Fraction("1.2")


def test_premises_of_the_odometer_have_each_a_twin() -> None:
    twins = [c for c in registered() if c.id.startswith("position_odometer.inside_with") or "any_fix" in c.id]
    assert len([c for c in twins if c.twin_of]) == len(position_odometer.PREMISES) + 2  # and two weaker ones
    assert position_drift.SOURCE and position_reading.ASSUMED


# --- correction, and all together ------------------------------------------------------------------------------------


def test_a_balise_corrects_the_position() -> None:
    """From a code at 900 m, 20 m/s, a wheel that counts 1 % too little: at 1000 m the balise is adopted."""
    per_metre = PULSES / (Fraction("0.86") * PI) * Fraction("0.99")
    names = ("sight.seen", "code.given", "sight.kind", "sight.since", "code.low", "code.place", "code.high")
    nothing = dict.fromkeys(names[:2], False) | dict.fromkeys(names[2:], 0)
    moving = {**nothing, "pulses": 20 * per_metre}
    rows = [{**nothing, "pulses": CYCLE * n * per_metre} for n in range(1, 201)]
    rows[-1] |= {"code.given": True, "code.low": 899, "code.place": 900, "code.high": 901}
    seen = run(Locator, [*rows, *[moving] * 50, {**moving, "sight.seen": True, "sight.since": 2 * Fraction("0.99")}])
    assert seen["position.guess"][249] == 900 + 50 * 2 * Fraction("0.99")
    assert not seen["matched.reliable"][198] and seen["matched.reliable"][199]
    assert seen["matched.adopted"][250] and seen["matched.fix.place"][250] == 1000
    assert seen["position.low"][250] < 1002 < seen["position.high"][250]


@pytest.mark.parametrize(
    ("model", "settings", "message"),
    [
        (Correction, {"data.place_b": 1040}, "nearest admissible spacing is any above 40.4 m"),
        (Decoder, {"jitter": Fraction("0.13")}, "nearest admissible jitter is any below 0.125 m"),
        (Decoder, {"eps": Fraction("0.02")}, "nearest admissible eps is any below 0.0199004 1"),
        (SpeedGenerator, {"diameter": 2}, "nearest admissible value is 1"),
    ],
)
def test_what_cannot_be_honoured_is_refused(model: type[Model], settings: dict[str, Fraction], message: str) -> None:
    with pytest.raises(ModelError, match=message):
        trace(model, settings)


def test_groups_too_near_each_other_are_refused() -> None:
    e, eps = Fraction(1, 10), Fraction(1, 100)
    assert (window(e, eps), span_tolerance(e, eps)) == (Fraction("40.602"), Fraction("0.602"))
    trace(Near)
    with pytest.raises(ModelError, match=r"nearest admissible place is any above 121\.204 m"):
        trace(Nearer)


class Near(Placing, tick_s=step_s):
    groups = (Group((5, 12, 30), Fraction(122)), Group((7, 20, 31), Fraction(0)))


class Nearer(Placing, tick_s=step_s):
    groups = (Group((7, 20, 31), Fraction(0)), Group((5, 12, 30), Fraction(121)))


class Mirrored(Placing, tick_s=step_s):
    groups = (Group((5, 12, 30), Fraction(0)), Group((10, 28, 35), Fraction(1000)))


class Palindrome(Placing, tick_s=step_s):
    groups = (Group((10, 20, 30), Fraction(0)),)


@pytest.mark.parametrize("model", [Mirrored, Palindrome])
def test_codes_that_do_not_tell_the_direction_are_refused(model: type[Model]) -> None:
    with pytest.raises(ModelError, match="one of them backwards"):
        trace(model)


class AllOfThem(Placing, tick_s=step_s):
    groups = tuple(Group(code, Fraction(1000 * n)) for n, code in enumerate(sorted(bose(TURNED))))


def test_ap_8_every_code_tells_place_and_direction() -> None:
    """247 groups, each passed both ways; codes that are not installed tell nothing."""
    ways = [(mirror(code) if back else code, at, back) for code, at in AllOfThem.groups for back in (False, True)]
    told = {"reading.accepted": True, "reading.rejected": False, "reading.origin": 80}
    rows = [{**told, **dict(zip(("reading.p", "reading.q", "reading.r"), code, strict=True))} for code, _, _ in ways]
    seen = run(AllOfThem, [*rows, {**rows[0], "reading.p": 1, "reading.q": 2, "reading.r": 3}])
    assert seen["fix.place"][:-1] == [at - 40 if back else at + 80 for _, at, back in ways]
    assert seen["rising"][:-1] == [not back for *_, back in ways]
    assert seen["fix.given"] == [True] * len(ways) + [False]
    assert seen["fix.high"][0] - seen["fix.low"][0] == 2 * (Fraction(1, 10) + Fraction(80, 100))


@pytest.mark.parametrize("back", [False, True])
def test_balises_to_fix(back: bool) -> None:
    """{7, 20, 31} at 30 km, passed either way: decoder and places together hold the train."""
    places = (0, *((9, 20, 33) if back else (7, 20, 31)), 40)
    runs = [b - a for a, b in zip([0, *places], places, strict=False)]
    still = {"balise": True, "reverses": False, "slips": False}
    seen = run(CodeReader, [*({**still, "run": way} for way in runs), {**still, "balise": False, "run": 45}])
    assert seen["fix.given"] == [False] * 5 + [True] and seen["rising"][-1] != back
    head = 30_040 - 85 if back else 30_085
    assert seen["fix.low"][-1] < head == seen["fix.place"][-1] < seen["fix.high"][-1]


BACKWARDS = {"balise": False, "reverses": False, "slips": False, "run": -5}
NO_FIX = dict.fromkeys(("fix.low", "fix.place", "fix.high", "wheel"), 0)


@pytest.mark.parametrize(
    ("model", "row"), [(Decoder, BACKWARDS), (Odometer, {**NO_FIX, "fix.given": True, "fix.low": 10, "fix.high": -10})]
)
def test_inputs_that_cannot_be_are_refused(model: type[Model], row: dict[str, object]) -> None:
    with pytest.raises(ModelError, match="breaks the assumption"):
        run(model, [row])


@pytest.mark.parametrize("hundredths", [0, 4, 14, 20, 27])
def test_a_balise_anywhere_in_a_cycle(hundredths: int) -> None:
    """At 100 km/h, the balise so many tenths of a metre before the end of its cycle: the train is in the interval."""
    speed, since = Fraction(250, 9), Fraction(hundredths, 10)
    per_metre = PULSES / (Fraction("0.86") * PI)
    still = {"sight.seen": False, "sight.kind": 0, "sight.since": 0, "pulses": 0, "code.given": False,
             **dict.fromkeys(("code.low", "code.place", "code.high"), 0)}  # fmt: skip
    rows = [{**still, "pulses": min(speed, n * CYCLE) * per_metre} for n in range(1, 300)]
    told = 1000 + since - 40 * speed * CYCLE
    rows[-1] |= {"code.given": True, "code.low": told, "code.place": told, "code.high": told}
    rows += [{**still, "pulses": speed * per_metre}] * 39
    rows.append({**still, "pulses": speed * per_metre, "sight.seen": True, "sight.since": since})
    seen = run(Locator, rows)
    assert seen["matched.adopted"][-1] and seen["position.guess"][-1] == 1000 + since
    off = Fraction(1, 10) + since / 100
    assert (seen["position.low"][-1], seen["position.high"][-1]) == (1000 + since - off, 1000 + since + off)
    broad = run(UnstampedLocator, rows)
    assert broad["position.low"][-1] <= 1000 + since <= broad["position.high"][-1]
