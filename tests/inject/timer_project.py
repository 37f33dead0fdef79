"""A small project on disk whose campaign is run in pieces, and told of: who begins and ends which piece, in a file."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from safety.commands.declared import Declared
from safety.inject.store import Store, Stored, campaign_key, open_executor, run_sharded

ROOT = Path(__file__).resolve().parents[2]
SIZE = 40  # injections of a shard
WORKERS = 2
PATIENCE_S = 180.0  # with anything that happens in a process

MODEL = """
from __future__ import annotations
from typing import NamedTuple
from safety import U3, U4, Bit, Model, point, power_up, select

class Lamp(NamedTuple):
    lit: Bit
    alarm: Bit

class Timer(Model, event="tick"):
    count: U4 = power_up(8)
    still: U3 = power_up(0)

    def step(self, run: Bit) -> tuple[Timer, Lamp]:
        count = point("count", self.count)
        total = point("sum", (count + point("run", run).word()).low(4))
        still = point("still", select(total == self.count, (self.still + 1).sat(3), 0))
        return Timer(count=total, still=still), Lamp(lit=point("lit", total >= 8), alarm=still == 7)
"""

CAMPAIGN = """
import os, time
from models.timer import Timer
from safety.inject import Campaign
from safety.inject.listing import stuck_bits

LIMIT, PAUSE = 8, float(os.environ.get("PAUSE", 0))

def log(text):
    if "LOG" in os.environ:
        with open(os.environ["LOG"], "a") as file:
            file.write(text + "\\n")

class Slow(Campaign):
    def judged(self, low, high):
        log(f"begin {low}")
        found = super().judged(low, high)
        time.sleep(PAUSE)
        log(f"end {low}")
        return found

Slow(
    id="timer", model=Timer, faults=stuck_bits("*"), stimulus={"run": True}, onsets=range(40), length=20, measured=64,
    hazard=lambda wires: wires.lasting(wires["lit"], LIMIT + 1), detectors={"stands": "alarm"},
)
"""


def write(root: Path) -> Path:
    """The project, in a folder."""
    for name, text in {"models/timer.py": MODEL, "proofs/timer.py": CAMPAIGN}.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return root


def files(folder: Path) -> dict[str, bytes]:
    """What lies in a campaign's folder."""
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def whole(root: Path, store: Path) -> Stored:
    """The campaign as it is without any trouble."""
    find = Declared(str(root), "timer")
    with open_executor("serial") as executor:
        return run_sharded(find(), find, Store(store), executor, size=SIZE)


def opened(root: Path, store: Path) -> Stored:
    """What a store holds of the campaign."""
    campaign = Declared(str(root), "timer")()
    return Store(store).open(campaign, campaign_key(campaign))


def environment(root: Path, pause: float = 0.02) -> dict[str, str]:
    """For a process that runs the campaign."""
    return {**os.environ, "PYTHONPATH": str(ROOT), "LOG": str(root / "log"), "PAUSE": str(pause)}


def driver(root: Path, store: Path, executor: str = f"processes:{WORKERS}") -> subprocess.Popen[str]:
    """A process that runs the campaign, in a session of its own."""
    return subprocess.Popen(
        [sys.executable, __file__, str(root), str(store), executor],
        env=environment(root), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True,
    )  # fmt: skip


def told(root: Path) -> dict[str, Counter[int]]:
    """How often each piece was begun, and ended, by its first injection."""
    found = {"begin": Counter[int](), "end": Counter[int]()}
    if (root / "log").exists():
        for line in (root / "log").read_text().splitlines():
            what, _, low = line.partition(" ")
            found[what][int(low)] += 1
    return found


def until(happened: Callable[[], object]) -> None:
    """Wait for something to happen."""
    end = time.monotonic() + PATIENCE_S
    while not happened():
        assert time.monotonic() < end, "it has not happened"
        time.sleep(0.005)


def wait_for_workers_to_end(root: Path) -> None:
    """Until no process of the campaign's is left: their driver is gone, they end after the piece in hand."""
    marker = f"LOG={root / 'log'}".encode()
    until(lambda: not any(marker in content for content in _environments()))


def workers(root: Path, driver: int) -> list[int]:
    """The worker processes of a driver."""
    return [
        int(path.name) for path in _processes() if _parent(path) == driver and b"spawn_main" in _read(path / "cmdline")
    ]


def kill(process: int) -> None:
    """kill -9."""
    os.kill(process, signal.SIGKILL)


def _processes() -> list[Path]:
    return [path for path in Path("/proc").iterdir() if path.name.isdecimal()]


def _environments() -> list[bytes]:
    return [_read(path / "environ") for path in _processes()]


def _parent(path: Path) -> int:
    fields = _read(path / "stat").rpartition(b")")[2].split()
    return int(fields[1]) if fields else 0


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError:  # it has ended
        return b""


def main(root: str, store: str, how: str) -> None:
    """Run the campaign as a command does."""
    find = Declared(root, "timer")
    with open_executor(how) as executor:
        stored = run_sharded(find(), find, Store(Path(store), print), executor, size=SIZE)
    print(stored.problems, len(stored.missing))


if __name__ == "__main__":
    main(*sys.argv[1:])
