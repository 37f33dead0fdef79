"""A small project on disk, and a way to call the command on it within this process."""

import json
import os
import subprocess
import sys
import textwrap
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

import pytest

from safety.commands import main
from tests.apart import forget

ROOT = Path(__file__).resolve().parents[2]

MODEL = '''
    """A pulse counter with an alarm."""
    from __future__ import annotations
    from typing import NamedTuple
    from safety import U4, Bit, Model, parameter, point, power_up, select

    class Out(NamedTuple):
        alarm: Bit

    class Counter(Model, tick_s="1/100"):
        """Counts pulses up to 15 and raises the alarm from the limit on."""
        n: U4 = power_up(0)
        limit: U4 = parameter(8, unit="pulse", within=(4, 12), source="[P] table 1")
        def step(self, pulse: Bit) -> tuple[Counter, Out]:
            seen = point("seen", pulse)
            n = select(seen & (self.n < 15), (self.n + 1).low(4), self.n)
            return Counter(n=point("n.next", n)), Out(alarm=point("alarm.out", self.n >= self.limit))
'''
CLAIMS = '''
    """Pulse counter: what is claimed."""
    from models.counter import Counter
    from safety import BOUNDED, PROVED, REFUTED, VACUOUS, Bit, Seen, at_most, claim, every, implies, stuck

    @claim(Counter, expect=PROVED, requirement="C-1")
    def alarm_at_twelve(s: Seen) -> Bit:
        """From twelve pulses on there is an alarm."""
        return implies(s.n >= 12, s.alarm)

    alarm_stuck = at_most(1, every(stuck(0), "alarm.out"))

    @claim(Counter, expect=REFUTED, faults=alarm_stuck, requirement="C-1", twin_of=alarm_at_twelve)
    def alarm_at_twelve_with_a_fault(s: Seen) -> Bit:
        """The same with a stuck alarm."""
        return alarm_at_twelve(s)

    @claim(Counter, expect=BOUNDED, steps=3, requirement="C-2")
    def five_is_far(s: Seen) -> Bit:
        """Five pulses do not come in three steps."""
        return s.n != 5

    @claim(Counter, expect=VACUOUS)
    def nothing_said(s: Seen) -> Bit:
        """The premise cannot happen."""
        return implies(s.n > 20, s.alarm)
'''
HAZARD = '''
    """Pulse counter: how the alarm is lost."""
    from models.counter import Counter
    from safety import Bit, Scenario, Seen, every, hazard, stuck

    def runs(names):
        return [Scenario(steps=20, inputs={"pulse": True}, present=names)]

    @hazard(Counter, faults=every(stuck(0), "seen", "alarm.out"), scenarios=runs, hours="1000", expect={1: 1},
            rates={"alarm.out stuck-at-0": ("1e-6", "[A] guess"), "seen stuck-at-0": ("1e-6", "[A] guess")})
    def no_alarm(s: Seen) -> Bit:
        """Twelve pulses and no alarm."""
        return (s.n >= 12) & ~s.alarm
'''
CAMPAIGN = '''
    """Pulse counter: what single faults do."""
    from models.counter import Counter
    from safety.inject import Campaign, stuck_bits

    Campaign(
        id="counter_stuck", model=Counter, faults=stuck_bits("seen", "alarm.out"), stimulus={"pulse": True},
        observe={"alarm": "alarm"}, measured=20, wrong_side=lambda seen: seen.total("alarm") < seen.healthy("alarm"),
        detected=lambda seen: seen.total("alarm") > seen.healthy("alarm"),
    )
'''
RATE = '''
    """Pulse counter: how long it lives."""
    from fractions import Fraction
    from safety.rates.claims import rate

    rate(id="counter.life", quantity="mean time to failure", unit="h", source="[A]",
         routes={"inverse": lambda: 1 / Fraction(1, 10**6), "direct": lambda: Fraction(10**6)})
'''
FILES = {
    "models/counter.py": MODEL,
    "proofs/counter.py": CLAIMS,
    "proofs/counter_hazard.py": HAZARD,
    "proofs/counter_campaign.py": CAMPAIGN,
    "proofs/counter_rate.py": RATE,
}


@dataclass
class Called:
    """What a call of the command left."""

    code: int
    out: str
    err: str


Run = Callable[..., Called]


def put(root: Path, name: str, text: str) -> Path:
    path = root / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(textwrap.dedent(text).lstrip(), encoding="utf-8")
    return path


@pytest.fixture
def project(tmp_path: Path) -> Path:
    for name in ("models/counter.py", "proofs/counter.py"):
        put(tmp_path, name, FILES[name])
    return tmp_path


@pytest.fixture
def whole(project: Path) -> Path:
    for name, text in FILES.items():
        put(project, name, text)
    return project


@pytest.fixture
def run(project: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Run:
    """Call `rightside` with these words in the project's folder."""
    monkeypatch.chdir(project)

    def call(*words: str) -> Called:
        forget()
        capfd.readouterr()
        code = main(list(words))
        return Called(code, *capfd.readouterr())

    return call


def document(path: Path) -> Any:
    return json.loads(path.read_text(encoding="utf-8"))


def with_plug_in(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """pytest with the plug-in, warnings as errors, in a process of its own."""
    installed = entry_points(group="pytest11", name="rightside")  # pytest loads it of itself, and not twice
    plugin = [] if installed else ["-p", "safety.pytest_plugin"]
    options = ["-W", "error", "-p", "no:cacheprovider", "-p", "no:hypothesispytest", *plugin, *words]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(
        [sys.executable, "-m", "pytest", *options], cwd=folder, env=environment, capture_output=True, text=True
    )
