"""The audit of TS-7: its verdicts against the table of the specification, and that each of them can fail."""

from __future__ import annotations

from dataclasses import replace

import pytest

from proofs import (
    ts7_accuracy,
    ts7_channel,
    ts7_derived_figures,
    ts7_figures,
    ts7_power,
    ts7_rollback,
    ts7_synchronisation,
    ts7_thresholds,
    ts7_window,
)
from proofs.ts7_campaign import ring_single_stuck
from safety import PROVED, REFUTED
from safety.audit import Figure, declared
from safety.audit.entry import Entry
from safety.audit.text import text
from safety.audit.verdict import CONFIRMED, INCONSISTENT, NOT_DERIVABLE, ROUNDING
from safety.prove.bounds.claims import declared as bounds
from safety.prove.claims import registered

CLAIMS_OF = (
    ts7_accuracy, ts7_channel, ts7_power, ts7_rollback, ts7_synchronisation, ts7_thresholds, ts7_window,
)  # fmt: skip
PRINTED = {each.id.removeprefix("ts7."): each for each in declared() if each.paper == ts7_figures.paper.title}
DERIVED = [each for each in declared() if each.paper == ts7_derived_figures.paper.title]
NUMBERS = [each for each in [*PRINTED.values(), *DERIVED] if isinstance(each, Figure)]

# What the specification says of the printed figures, and what the audit then has to find
SPECIFICATION = {
    "ring.rate": INCONSISTENT,  # 512/32 = 16 kHz
    "ring.oscillator": INCONSISTENT,
    "ring.frame": CONFIRMED,  # 8 kHz and 0.125 ms
    "ring.rate_by_frame": CONFIRMED,
    "ring.two_periods": CONFIRMED,  # 512 kHz needs two periods a bit
    "table1.wheel_steps": CONFIRMED,
    "text.boards": CONFIRMED,  # 5 = 3 + 2
    "table1.accuracy": CONFIRMED,
    "table1.reverse": INCONSISTENT,  # two nominal values,
    "table1.reverse_range": CONFIRMED,  # which are consistent
    "table1.reverse_word": CONFIRMED,
    "text.reverse": CONFIRMED,
    "window.share": NOT_DERIVABLE,
    "window.between": CONFIRMED,  # reconstructed
    "window.unit_fractions": CONFIRMED,
    "faults.most": INCONSISTENT,  # 77 of 163
    "faults.most_effective": CONFIRMED,  # 77 of 131
    "faults.most_wrong_side": CONFIRMED,  # 35 of 46
    "faults.shared_path": CONFIRMED,  # 70 of 70
    "faults.whichever": INCONSISTENT,
    "faults.whichever_wrong_side": INCONSISTENT,  # 11 undetected
    "table1.mains_tolerance": CONFIRMED,  # 60 +- 3 Hz and +-5 %
    "table1.mains_admitted": CONFIRMED,
    "table1.consumption": CONFIRMED,  # 130 VA on 200 VA
    "table1.overload": CONFIRMED,  # 300 VA is 150 %
    "table1.load_resistance": NOT_DERIVABLE,  # illegible
    "mtbf": NOT_DERIVABLE,
    "tests.read_as_days": INCONSISTENT,  # 7 + 3 = 10 days
    "tests.read_as_periods": CONFIRMED,
    "boards.half": NOT_DERIVABLE,
    "parts.share": NOT_DERIVABLE,
    "parts.range": NOT_DERIVABLE,
}
RECOMPUTED = {
    "ring.rate": "16", "ring.oscillator": "256", "table1.reverse": "5", "tests.read_as_days": "10",
    "ring.two_periods": "periods = 2", "faults.most": "found = 77; faults/2 = 81.5",
    "faults.whichever_wrong_side": "faults = 11", "faults.shared_path": "found = 70; faults = 70",
    "faults.most_wrong_side": "found = 35; faults/2 = 23", "window.any_fractions": "readings = 10",
    "table1.accuracy": "0.818228", "table1.reverse_word": "limit = 5.18363",
}  # fmt: skip


@pytest.mark.parametrize(("name", "verdict"), SPECIFICATION.items())
def test_the_verdict_of_the_specification_is_found(name: str, verdict: str) -> None:
    assert PRINTED[name].judged.verdict == verdict, PRINTED[name].judged


@pytest.mark.parametrize(("name", "value"), RECOMPUTED.items())
def test_what_was_recomputed_is_shown(name: str, value: str) -> None:
    assert value in PRINTED[name].judged.recomputed


def test_all_others_that_no_claim_decides_are_confirmed() -> None:
    others = {
        name: each.judged.verdict for name, each in PRINTED.items() if name not in SPECIFICATION and not each.claim
    }
    assert set(others.values()) == {CONFIRMED}
    assert len(PRINTED) > 60


@pytest.mark.parametrize("each", [each for each in PRINTED.values() if each.claim], ids=lambda each: each.id)
def test_words_that_a_claim_decides_name_one_with_a_verdict(each: Entry) -> None:
    assert CLAIMS_OF
    stated = {one.id: one.expect for one in [*registered(), *bounds()]}
    false = {"response_brake_half_a_step_off", "response_brake_without_signal", "within_accuracy"}
    wanted = REFUTED if each.id.rpartition(".")[2] in false else PROVED
    assert stated[each.claim] == wanted


@pytest.mark.parametrize("each", DERIVED, ids=lambda each: each.id)
def test_what_the_specification_derives_holds(each: Entry) -> None:
    forward = "mtbf.repair" in each.id or "mtbf.common_part" in each.id
    assert each.judged.verdict == (ROUNDING if forward else CONFIRMED), each.judged


def test_another_last_digit_would_be_noticed() -> None:
    unnoticed = []
    for each in NUMBERS:
        if each.judged.verdict == CONFIRMED and not each.judged.note:  # a tie would do with either digit
            last = max(i for i, sign in enumerate(each.printed) if sign.isdigit())
            digits = sum(sign.isdigit() for sign in each.printed) if " " in each.printed else None
            other = str((int(each.printed[last]) + 5) % 10)
            spoilt = each.printed[:last] + other + each.printed[last + 1 :]
            if each.if_printed(text(spoilt, digits)).verdict == CONFIRMED:
                unnoticed.append(each.id)
    assert unnoticed == []


def test_the_factor_two_is_not_put_in() -> None:
    """With 256 kHz in print nothing would be wrong, and with 1024 kHz the factor would be 4."""
    oscillator = PRINTED["ring.oscillator"]
    assert isinstance(oscillator, Figure)
    assert oscillator.if_printed(text("256")).verdict == CONFIRMED
    assert oscillator.if_printed(text("1024")).verdict == INCONSISTENT


def test_the_counts_are_those_of_the_campaign(monkeypatch: pytest.MonkeyPatch) -> None:
    fewer = replace(ring_single_stuck, detected=lambda counts: counts.ever("o2") & ~counts.ever("o2"))
    ts7_figures.campaign.cache_clear()
    monkeypatch.setattr(ts7_figures, "ring_single_stuck", fewer)
    try:
        judged = PRINTED["faults.shared_path"].judge()
        assert (judged.verdict, judged.recomputed) == (INCONSISTENT, "found = 0; faults = 70")
    finally:
        ts7_figures.campaign.cache_clear()


def test_two_equations_that_are_wrong_are_refuted() -> None:
    paper = ts7_derived_figures.paper
    wrong = {"e10": "MTTF = (5*λ + μ)/((3*λ + λc)*(2*λ + λc) + μ*λc)", "e6": "permitted = V_E*d'/d"}
    made = [paper.equation(f"wrong.{name}", equation, where="planted") for name, equation in wrong.items()]
    try:
        assert {each.judged.verdict for each in made} & {CONFIRMED, ROUNDING} == set()
    finally:
        from safety.audit import entry

        for each in made:
            entry._declared.pop(each.id)
            paper.equations.pop(each.id.removeprefix("ts7_derived."))
