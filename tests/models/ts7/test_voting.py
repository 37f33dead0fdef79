"""Relays, synchronisation, isolation, vote and power: the common part and what stands around it."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import Any

import pytest

from models.ts7 import contacts
from models.ts7.contacts import EB_CHAIN, NB_RULE_A, NB_RULE_B
from models.ts7.power import Power
from models.ts7.voting import (
    BothMustBrake,
    CommonPart,
    EdgeSynchronisation,
    Relay,
    SettlingSynchronisation,
    Synchronisation,
    Trio,
)
from safety.model import Model
from safety.terms.values import bit
from safety.trace import Trace, run

RUNS = {"drive": True, "brake": False, "fault": False, "rev": False}
BRAKES = {"drive": False, "brake": True, "fault": False, "rev": False}
FAULTY = {"drive": False, "brake": False, "fault": True, "rev": False}
BACKWARD = {"drive": True, "brake": False, "fault": False, "rev": True}


def test_relay_times() -> None:
    """Operates in 30 ms, releases in 20 ms; a shorter change of the coil does not move it."""
    coil = [True] * 300 + [False] * 200 + [True] * 240 + [False] * 10 + [True] * 300
    contact = run(Relay, ({"energised": on} for on in coil))["out"]
    moved = [k for k in range(1, len(contact)) if contact[k] != contact[k - 1]]
    assert moved == [240, 300 + 160, 750 + 240]
    quick = run(Relay, ({"energised": on} for on in coil), settings={"operate": 0, "release": 0})
    assert quick["out"] == coil


def windows(model: type[Synchronisation], brakes: Callable[[int], str], frames: int) -> tuple[str, Trace]:
    """Isolated channels after some frames; `brakes` names those that brake."""

    def row(k: int) -> dict[str, Any]:
        now, before = brakes(k), brakes(k - 1) if k else ""
        commands = {f"brakes.{n}": n in now for n in "abc"} | {f"faults.{n}": False for n in "abc"}
        return {**commands, "starts": bool(set(now) - set(before)), "out_of_service": False}

    seen = run(model, row, frames)
    return "".join(n for n in "abc" if seen[f"cut_{n}"][-1]), seen


@pytest.mark.parametrize(
    ("brakes", "isolated"),
    [
        (lambda k: "a", "a"),  # neither other follows: the first is faulty
        (lambda k: "a" if k < 300 else "abc", ""),  # both follow: normal brake
        (lambda k: "a" if k < 300 else "ab", "c"),  # one follows: the silent one is isolated
        (lambda k: "bc", "a"),  # two at once with a silent third
        (lambda k: "a" if k < 3999 else "abc", ""),  # brakes: at any instant of the window
        (lambda k: "a" if k < 300 else "abc" if k < 310 else "a", ""),
        (lambda k: "abc", ""),
        (lambda k: "", ""),
    ],
)
def test_window_outcomes(brakes: Callable[[int], str], isolated: str) -> None:
    got, seen = windows(Synchronisation, brakes, 4004)
    assert got == isolated
    lowered = [not first and window for first, window in zip(seen["window.first_a"], seen["window.open"], strict=True)]
    if brakes(0) == "a":
        assert seen["window.open"].index(True) == 1 and sum(seen["window.open"][:4002]) == 4000
        assert not any(lowered)


def test_no_synchronisation_after_an_isolation() -> None:
    got, seen = windows(Synchronisation, lambda k: "a" if k < 5000 else "ab", 14_000)
    assert got == "a" and sum(seen["window.open"]) == 4000


def test_a_channel_that_falls_silent_while_all_brake() -> None:
    """The level rule finds it; the edge rule, the required counterexample, never does."""

    def falls_silent(k: int) -> str:
        return "abc" if 10 <= k < 5000 else "ab" if k >= 5000 else ""

    assert windows(Synchronisation, falls_silent, 9002)[0] == "c"
    assert windows(EdgeSynchronisation, falls_silent, 30_000)[0] == ""
    assert windows(EdgeSynchronisation, lambda k: "a" if k > 5 else "", 5000)[0] == "a"


def test_release_one_frame_apart_isolates_a_healthy_channel() -> None:
    """The price of the level rule: the first to release stands alone as silent; the settling variant knows better."""

    def releases(k: int) -> str:
        return "abc" if k < 100 else "bc" if k == 100 else ""

    assert windows(Synchronisation, releases, 5000)[0] == "a"
    assert windows(SettlingSynchronisation, releases, 5000)[0] == ""
    assert windows(SettlingSynchronisation, lambda k: "ab" if k > 5 else "", 5000)[0] == "c"
    assert windows(EdgeSynchronisation, releases, 5000)[0] == ""


def common(demands: str, model: type[CommonPart] = CommonPart, frames: int = 5600, supply: bool = True) -> Trace:
    """A run of the common part; one letter a channel from frame 1000 on: r(uns), b(rakes), f(aulty), < backward."""
    meaning = {"r": RUNS, "b": BRAKES, "f": FAULTY, "<": BACKWARD}

    def row(k: int) -> dict[str, Any]:
        now = demands if k >= 1000 else "rrr"
        of = {f"{n}.{name}": v for n, letter in zip("abc", now, strict=True) for name, v in meaning[letter].items()}
        return {**of, "supply": supply or k < 1000}

    return run(model, row, frames)


@pytest.mark.parametrize(
    ("demands", "nb", "eb", "targets"),
    [
        ("rrr", False, False, ""),
        ("brr", False, False, "a"),
        ("bbr", True, False, "c"),
        ("bbb", True, False, ""),
        ("frr", False, False, "a"),
        ("frb", True, False, "a"),
        ("ffr", True, True, "ab"),
        ("fff", True, True, "abc"),
        ("<rr", False, True, ""),
        ("rr<", False, True, ""),
    ],
)
def test_rule_a(demands: str, nb: bool, eb: bool, targets: str) -> None:
    """P21 among them: any roll-back alone gives EB, two isolated give EB."""
    seen = common(demands)
    assert not seen["nb"][900] and not seen["eb"][900]
    assert (seen["nb"][-1], seen["eb"][-1]) == (nb, eb)
    assert "".join(n for n in "abc" if seen[f"targets.{n}"][-1]) == targets
    assert all(seen[f"brakes.{n}"][-1] for n in targets)


def test_rule_b_releases_with_one_of_two() -> None:
    assert not common("frb", BothMustBrake)["nb"][-1]
    assert common("fbb", BothMustBrake)["nb"][-1]


def test_times_of_the_outputs() -> None:
    """NB: NBRR 20 ms and NB 20 ms after the drives stop; EB 20 ms after a roll-back."""
    assert common("bbb")["nb"].index(True, 900) == 1000 + 160 + 160
    assert common("<rr")["eb"].index(True, 900) == 1000 + 160


def test_p21_loss_of_the_supply_drops_all_relays() -> None:
    seen = common("rrr", supply=False, frames=1400)
    assert seen["nb"][-1] and seen["eb"][-1] and not any(seen[f"targets.{n}"][-1] for n in "abc")


def test_power_up_brakes_until_the_relays_are_up() -> None:
    seen = common("rrr", frames=1000)
    assert (seen["nb"].index(False), seen["eb"].index(False)) == (3 * 240, 2 * 240)


@pytest.mark.parametrize("lost", [("inverter",), ("mg",), ("inverter", "mg"), ("inverter late",)])
def test_power(lost: tuple[str, ...]) -> None:
    def row(k: int) -> dict[str, bool]:
        late = 100 <= k < 150 and "inverter late" in lost
        return {"inverter": not ("inverter" in lost and k >= 100) and not late, "mg": not ("mg" in lost and k >= 100)}

    supply = run(Power, row, 1200)["supply"]
    assert all(supply[:100])
    expected = {("inverter",): 400, ("mg",): 0, ("inverter", "mg"): 1100, ("inverter late",): 50}
    assert supply.count(False) == expected[lost]


def value(x: Any) -> bool:
    return bool(x.attr)


def rule(model: type[CommonPart], up: dict[str, bool]) -> bool:
    runs, isolated = (Trio(*(bit(up[f"{relay}_{n}"]) for n in "abc")) for relay in ("nbrr", "chr"))
    isolated = Trio(*(~in_service for in_service in isolated))
    return value(model.released(None, runs, isolated))  # type: ignore[arg-type]


def positions(*names: str) -> list[dict[str, bool]]:
    relays = [f"{name}_{n}" for name in names for n in "abc"]
    return [dict(zip(relays, ups, strict=True)) for ups in product((False, True), repeat=len(relays))]


@pytest.mark.parametrize(("network", "model"), [(NB_RULE_A, CommonPart), (NB_RULE_B, BothMustBrake)])
def test_voter_network_is_the_voting_rule(network: contacts.Network, model: type[CommonPart]) -> None:
    for up in positions("nbrr", "chr"):
        assert contacts.conducts(network, up) is rule(model, up), up


def test_eb_network_is_the_rule_of_the_model() -> None:
    for up in positions("chr", "rev"):
        isolated, rev = [not up[f"chr_{n}"] for n in "abc"], any(up[f"rev_{n}"] for n in "abc")
        assert contacts.conducts(EB_CHAIN, up) is (sum(isolated) < 2 and not rev)
    assert contacts.relays(EB_CHAIN) == [f"{r}_{n}" for r in ("chr", "rev") for n in "abc"]


def names(sets: set[frozenset[str]]) -> set[str]:
    return {" ".join(sorted(s)) for s in sets}


def test_paths_and_cuts_of_the_networks() -> None:
    pairs = {"nbrr_a nbrr_b", "nbrr_b nbrr_c", "nbrr_a nbrr_c"}
    assert names(contacts.paths(NB_RULE_A)) == names(contacts.cuts(NB_RULE_A)) == pairs
    rev = "~rev_a ~rev_b ~rev_c"
    assert names(contacts.paths(EB_CHAIN)) == {f"chr_{x} chr_{y} {rev}" for x, y in ("ab", "bc", "ac")}
    assert names(contacts.cuts(EB_CHAIN)) == {*rev.split(), "chr_a chr_b", "chr_b chr_c", "chr_a chr_c"}
    assert len(contacts.paths(NB_RULE_B)) == 12


def test_variants_differ_in_what_they_say() -> None:
    assert issubclass(EdgeSynchronisation, Model) and "opens" in vars(EdgeSynchronisation)
    assert any(rule(CommonPart, up) is not rule(BothMustBrake, up) for up in positions("nbrr", "chr"))
