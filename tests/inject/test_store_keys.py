"""A campaign's key: another for whatever could change an answer, the same for everything else and in every process."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from safety.commands.declared import Declared
from safety.inject import CampaignError
from safety.inject.store import campaign_key, keys
from safety.inject.store.shards import StoreError
from tests.inject import timer_project as timer
from tests.test_house import CORE

BY_FUNCTIONS = '''
import models.timer as equipment
from models.timer import Timer
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from functools import partial
from typing import NamedTuple
from safety.inject import Campaign
from safety.inject.listing import stuck_bits

LIMIT = 8

class Bounds(NamedTuple):
    """Of the frames."""
    low: int
    high: int = 1000

class Way(Enum):
    UP, DOWN = 1, 2

@dataclass(frozen=True)
class Ride:
    """How it is run."""
    go: bool
    stop: int = 60

    def __call__(self, frame):
        return {"run": self.go and frame < self.stop and Bounds(frame).low < Bounds(frame).high}

    @property
    def most(self):
        return LIMIT + 2

def enough(counts, way, most=0):
    """Whether it is lit too long."""
    found = counts.total("lit") > RIDE.most + most
    return found if way is Way.UP else ~found

RIDE = Ride(True)

def wrong(counts):
    return enough(counts, Way.UP) | (counts.total("lit") > equipment.FAR)

found = lambda counts: counts.ever("alarm")

Campaign(
    id="timer", model=Timer, faults=stuck_bits("count", "sum"), stimulus=RIDE, measured=64, run_in=0, seed=3,
    observe={"lit": "lit", "alarm": lambda wires: wires["alarm"]}, wrong_side=wrong,
    detected=found, safe_side=partial(enough, way=Way.DOWN, most=5),
)
'''


@pytest.fixture
def key_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., str]:
    """The key of the campaign with some words replaced in its files."""

    def key_of(*changes: tuple[str, str], campaign: str = BY_FUNCTIONS) -> str:
        root = timer.write(tmp_path_factory.mktemp("keyed"))
        texts = {"models/timer.py": timer.MODEL + "\nFAR = 1000\n", "proofs/timer.py": campaign}
        for old, new in changes:
            assert any(old in text for text in texts.values()), old
            texts = {name: text.replace(old, new) for name, text in texts.items()}
        for name, text in texts.items():
            (root / name).write_text(text)
        return campaign_key(Declared(str(root), "timer")())

    return key_of


def test_whatever_could_change_an_answer_makes_another_key(key_of: Callable[..., str]) -> None:
    found = {
        "as it is": key_of(),
        "model": key_of(("total >= 8", "total >= 9")),
        "power-up value": key_of(("power_up(8)", "power_up(7)")),
        "global value": key_of(("LIMIT = 8", "LIMIT = 9")),
        "function called by the judge": key_of(('counts.total("lit") > RIDE', 'counts.total("lit") >= RIDE')),
        "value of a module": key_of(("FAR = 1000", "FAR = 1001")),
        "property of an object": key_of(("LIMIT + 2", "LIMIT + 3")),
        "object": key_of(("Ride(True)", "Ride(True, 50)")),
        "default of a named tuple": key_of(("high: int = 1000", "high: int = 999")),
        "enumeration": key_of(("enough(counts, Way.UP)", "enough(counts, Way.DOWN)")),
        "argument of a partial": key_of(("most=5", "most=6")),
        "detection": key_of(("lambda counts: counts.ever", "lambda counts: ~counts.ever")),
        "what is observed": key_of(('wires["alarm"]', '~wires["alarm"]')),
        "stimulus": key_of(("frame < self.stop", "frame <= self.stop")),
        "faults": key_of(('stuck_bits("count", "sum")', 'stuck_bits("count")')),
        "order of the faults": key_of(('stuck_bits("count", "sum")', 'stuck_bits("sum", "count")')),
        "order": key_of(("run_in=0", "run_in=0, order=2")),
        "sample": key_of(("run_in=0", "run_in=0, order=2, sample=7")),
        "seed of the sample": key_of(("run_in=0, seed=3", "run_in=0, order=2, sample=7, seed=4")),
        "timing": key_of(("measured=64", "measured=65")),
        "run-in": key_of(("run_in=0", "run_in=1")),
    }
    by_key: dict[str, list[str]] = {}
    for what, key in found.items():
        by_key.setdefault(key, []).append(what)
    assert [whats for whats in by_key.values() if len(whats) > 1] == []


def test_wires_and_draws_count(key_of: Callable[..., str]) -> None:
    drawn = timer.CAMPAIGN.replace("onsets=", 'vary={"run": lambda pick: pick.random() < 0.9}, scenarios=3, onsets=')
    drawn = drawn.replace('stimulus={"run": True}, ', "")
    found = [
        key_of(campaign=timer.CAMPAIGN),
        key_of(("LIMIT + 1", "LIMIT + 2"), campaign=timer.CAMPAIGN),
        key_of(("range(40)", "range(41)"), campaign=timer.CAMPAIGN),
        key_of(("length=20", "length=21"), campaign=timer.CAMPAIGN),
        key_of(('"stands": "alarm"', '"stands": "lit"'), campaign=timer.CAMPAIGN),
        key_of(campaign=drawn),
        key_of(("< 0.9", "< 0.8"), campaign=drawn),
        key_of(("scenarios=3", "scenarios=4"), campaign=drawn),
    ]
    assert len(set(found)) == len(found)


def test_words_and_expectations_make_no_other_key(key_of: Callable[..., str]) -> None:
    other = key_of(
        ("LIMIT = 8", "LIMIT = 8  # frames\n\n"),
        ("run_in=0", 'run_in=0, expect={"safe": 1}, confidence=0.9, engine="lanes", audit=True'),
    )
    assert other == key_of()


def test_a_changed_engine_is_another_key(key_of: Callable[..., str], monkeypatch: pytest.MonkeyPatch) -> None:
    before = key_of()
    monkeypatch.setattr(keys, "engine", lambda: "another")
    assert key_of() != before
    found = {path.relative_to(keys.PACKAGE).as_posix() for path in keys.files(keys.PACKAGE, keys.ENGINE)}
    assert {"trace.py", "terms/table.py", "inject/judging.py", "inject/lanes.py"} <= found
    assert {path.partition("/")[0].removesuffix(".py") for path in found} >= CORE
    concluding = {"statistics", "store"}
    folders = {path.name for path in (keys.PACKAGE / "inject").iterdir() if path.is_dir()} - {"__pycache__"}
    assert all(any(path.startswith(f"inject/{folder}/") for path in found) for folder in folders - concluding)


def test_the_key_is_the_same_in_every_process(tmp_path: Path) -> None:
    root = timer.write(tmp_path)
    (root / "proofs" / "timer.py").write_text(BY_FUNCTIONS.replace("equipment.FAR", "{1, 2, 1000}.__len__()"))
    ask = (
        "import sys; from safety.commands.declared import Declared; from safety.inject.store import campaign_key; "
        "print(campaign_key(Declared(sys.argv[1], 'timer')()))"
    )
    said = {
        subprocess.run(
            [sys.executable, "-c", ask, str(root)],
            env={**timer.environment(root), "PYTHONHASHSEED": seed}, capture_output=True, text=True, check=True,
        ).stdout
        for seed in ("1", "2")
    }  # fmt: skip
    assert len(said) == 1


def test_running_a_campaign_does_not_change_its_key(tmp_path: Path) -> None:
    root = timer.write(tmp_path)
    (root / "proofs" / "timer.py").write_text(
        BY_FUNCTIONS.replace("RIDE = Ride(True)", "RIDE = Ride(True)\nBOUND = Bound(3)")
        .replace("class Way(Enum)", "class Bound:\n    def __init__(self, n): self.n = n\n\n    @cached_property\n"
                 "    def most(self): return self.n + 7\n\nclass Way(Enum)")
        .replace("import partial", "import cached_property, partial")
        .replace("> RIDE.most", "> BOUND.most").replace("equipment.FAR", "1000")
    )  # fmt: skip
    campaign = Declared(str(root), "timer")()
    before = campaign_key.__wrapped__(campaign)
    with pytest.raises(CampaignError, match="the fault-free run is judged wrong"):  # so the judges have run
        campaign.inject()
    assert campaign_key.__wrapped__(campaign) == before


def test_what_cannot_be_written_down_has_no_key(key_of: Callable[..., str]) -> None:
    with pytest.raises(StoreError, match="results can be kept only of functions whose values are plain data"):
        key_of(("LIMIT = 8", "LIMIT = iter([8])"), ("LIMIT + 2", "next(LIMIT)"))


@pytest.mark.parametrize("forgotten", ["_code", "_used", "_class"])
def test_a_key_that_forgets_code_is_noticed(
    key_of: Callable[..., str], monkeypatch: pytest.MonkeyPatch, forgotten: str
) -> None:
    monkeypatch.setattr(keys._CampaignText, forgotten, lambda *_: [])
    with pytest.raises(AssertionError):
        test_whatever_could_change_an_answer_makes_another_key(key_of)
