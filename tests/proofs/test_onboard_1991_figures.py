"""The audit of the 1991 paper comes to what the specifications say, row by row of their verdict tables.

Differences between those tables and the audit, all of them on purpose:
- "balise spacing keeps the accuracy: confirmed only without uncorrected slide" is two entries, with and without one.
- "reference points every several 10 km: consistent only with intermediate balises" likewise.
- "5 s alarm: consistent up to 102.30 km/h" rests on speed and brake, which are not printed: assumed.
- "9,139 only with known direction": the number is confirmed, that it holds both ways is inconsistent.
- "about 6 states: consistent", with two for each kind; if the frequency alone told the four kinds apart, 8 would be
  needed: inconsistent in that reading.
- "moving block, confirmed in direction", by 34.0 against 55.4 s: shown here for all speeds, brakes and blocks of which
  all but one hold the braking way; the two numbers are among those not in print.
"""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from itertools import combinations
from math import comb

import pytest

from models.kinematics import B_EMERGENCY, B_SERVICE, MARGIN, T_EMERGENCY, T_SERVICE, ceiling, distance, kmh, mps
from proofs import onboard_1991_derived_systems, onboard_1991_words
from proofs.onboard_1991_derived_figures import PASSIVE, alike, figures
from safety import PROVED, REFUTED
from safety.audit import Entry, Figure, Span, declared, derived, number
from safety.audit.text import text
from tests.proofs.verdicts import stated_in

FILES = (onboard_1991_words, onboard_1991_derived_systems)
CLOSE = Fraction(1, 10**15)


def entries(paper: str) -> dict[str, Entry]:
    """Those of a paper by name."""
    return {each.id.removeprefix(f"{paper}."): each for each in declared() if each.id.startswith(f"{paper}.")}


ENTRIES, DERIVED = entries("onboard_1991"), entries("onboard_1991_derived")
VERDICTS = {
    "codes": "confirmed",
    "balises": "confirmed",
    "codes.both_ways": "inconsistent",
    "accuracy.counted": "confirmed",
    "accuracy.slid": "inconsistent",
    "alarm.fits": "assumed",
    "reference.alone": "inconsistent",
    "reference.with_balises": "confirmed",
    "states.kind": "confirmed",
    "states.together": "inconsistent",
    "later.than_steps": "confirmed",
    "moving_block": "confirmed",
    "chapter": "misprint",
    "word.global": "misprint",
}


@pytest.mark.parametrize(("name", "verdict"), VERDICTS.items())
def test_what_is_printed_is_judged_as_the_specifications_judge_it(name: str, verdict: str) -> None:
    assert ENTRIES[name].judged.verdict == verdict


def test_what_nothing_fixes_is_not_derivable() -> None:
    judged = {name: each.judged.verdict for name, each in ENTRIES.items() if not each.claim and name not in VERDICTS}
    assert set(judged.values()) == {"not derivable"} and len(judged) >= 23
    assert {"count.transponder_bits", "count.aspects_most", "count.speeds_now", "alarm", "told.gps"} <= set(judged)


def test_every_verdict_has_its_reason() -> None:
    assert ENTRIES["alarm.fits"].judged.note.startswith("confirmed with the reference, inconsistent with V = 130")
    assert (ENTRIES["chapter"].judged.mended, ENTRIES["word.global"].judged.mended) == ("6", "Global")
    assert ENTRIES["codes.both_ways"].judged.recomputed == "classes = 4579; codes = 9139"


@pytest.mark.parametrize("name", DERIVED)
def test_what_the_specifications_derive_holds(name: str) -> None:
    judged = DERIVED[name].judged
    assert judged.verdict == "confirmed" or judged.note.startswith("confirmed with the reference")


def test_every_brake_and_time_is_shown_as_assumed() -> None:
    for name, entry in DERIVED.items():
        if name.split(".")[0] in ("two_stage", "wheel", "release", "dual", "crossing") and entry.kind == "number":
            assert entry.judged.assumed, name


def test_every_printed_number_of_the_specifications_is_there() -> None:
    assert {each.printed for each in ENTRIES.values() if each.kind == "number"} >= {
        "5",
        "9,139",
        "48",
        "6",
        "20",
        "8",
        "3",
    }
    assert Counter(entry.kind for entry in ENTRIES.values())["number"] >= 12 and len(DERIVED) > 85


@pytest.mark.parametrize("other", ["9,138", "9,193", "9,880"])
def test_another_number_of_codes_is_not_confirmed(other: str) -> None:
    each = ENTRIES["codes"]
    assert isinstance(each, Figure) and each.if_printed(text(other)).verdict == "inconsistent"


def test_words_rest_on_claims_that_are_stated_as_they_are_judged() -> None:
    assert stated_in(ENTRIES) == {
        "alarm.brakes": PROVED,
        "later.last_moment": PROVED,
        "later.safe": PROVED,
        "dual.compared": PROVED,
        "dual.permit": PROVED,
        "branch.limit": PROVED,
        "phase.release": PROVED,
        **dict.fromkeys(("codes.recognised", "codes.first", "codes.second", "codes.third"), PROVED),
        "correction.matched": PROVED,
        "crossing.delay": PROVED,
        "radio.routes": PROVED,
        "radio.follows": PROVED,
        "alarm.alone": REFUTED,
        "accuracy.large_error": REFUTED,
    }
    assert {name for name, entry in ENTRIES.items() if entry.denies} == {"alarm.alone", "accuracy.large_error"}


# --- the same by enumeration and by the models, which share no formula with the audit --------------------------------


def value(name: str) -> Fraction:
    """As recomputed, exact but for roots."""
    found = DERIVED[name].judged.value
    assert found is not None
    return found.middle


def test_9139_is_one_binomial_and_other_counts_are_as_many_as_they_are() -> None:
    assert comb(39, 3) == 9139
    assert [alike(Span(n)) for n in (9139, 9140, 120, 3003)] == [1, 0, 2, 3]  # 120 and 3003 are known to repeat


def test_the_codes_are_those_that_can_be_listed() -> None:
    codes = set(combinations(range(1, 40), 3))
    mirror = {each: tuple(sorted(40 - slot for slot in each)) for each in codes}
    assert len(codes) == value("codes.others") + value("codes.palindromes") == 9139
    assert sum(mirror[each] == each for each in codes) == value("codes.palindromes")
    assert len({min(each, mirror[each]) for each in codes}) == value("codes.classes")
    beside = {
        frozenset((each, moved))
        for each in codes
        for n in range(3)
        if (moved := tuple(sorted((*each[:n], each[n] + 1, *each[n + 1 :])))) in codes
    }
    assert len(beside) == value("codes.beside")
    assert value("codes.beside_mean") == Fraction(2 * len(beside), 9139)


@pytest.mark.parametrize("speed", PASSIVE)
def test_warning_distances_are_those_of_the_kinematics(speed: int) -> None:
    assert value(f"passive.{speed}") == distance(mps(speed), B_EMERGENCY, T_EMERGENCY + 5)


def test_ceilings_are_those_of_the_kinematics() -> None:
    for name, place in (("two_stage.D_1", 600), ("two_stage.D_2", 180)):
        assert abs(value(name) - kmh(ceiling(place - MARGIN, B_SERVICE, T_SERVICE).middle)) < CLOSE
    assert abs(value("passive.fastest") - kmh(ceiling(600, B_EMERGENCY, T_EMERGENCY + 5).middle)) < CLOSE
    assert abs(value("release.restored") - kmh(ceiling(100, B_EMERGENCY, T_EMERGENCY).middle)) < CLOSE
    assert value("radio.lost") == mps(100) * 3 + distance(mps(100), B_SERVICE, T_SERVICE)


def test_a_planted_error_is_seen() -> None:
    """40 places in place of 39, the alarm left out: the figures are not confirmed."""
    wrong = (
        ("9,139", "1", "codes", {"slots": derived(40)}),
        ("577.38", "m", "V*t_e + V^2/(2*b_e)", {"V": derived(100)}),
    )
    for shown, unit, by, given in wrong:
        judged = number.judge(text(shown), figures.symbols.bound(by, unit, given), {})
        assert judged.verdict in ("inconsistent", "assumed") and not judged.note.startswith("confirmed")
