"""At the command line: claims that say nothing, solvers without memory, and an interrupt in the middle."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from safety.prove import search
from tests.commands.conftest import Run, document, put

HEAD = """
    import os, time
    from models.counter import Counter
    from safety import PROVED, REFUTED, VACUOUS, Bit, Seen, claim, word
"""
NO_MEMORY = """
    import z3
    import safety.prove.search

    full = compile("def full(*_, **__): raise z3.Z3Exception(b'out of memory')", "not of the project", "exec")
    there = {"z3": z3}
    exec(full, there)
    safety.prove.search.Solver = there["full"]

    @claim(Counter, expect=REFUTED)
    def too_large(s: Seen) -> Bit:
        '''A claim.'''
        return ~s.alarm
"""
NOTHING = """
    @claim(Counter, expect=PROVED)
    def nothing(s: Seen) -> Bit:
        '''A claim about no signal.'''
        return word(3, 4) <= 5
"""


def contradictory(expect: str) -> str:
    return f"""
    @claim(Counter, expect={expect}, given=lambda s: s.pulse & ~s.pulse)
    def never(s: Seen) -> Bit:
        '''A claim about nothing that happens.'''
        return s.n < 3
"""


@pytest.mark.parametrize(
    ("body", "code", "said"),
    [
        (NOTHING, 2, "bad.nothing names no signal: it says True whatever the model does"),
        (contradictory("PROVED"), 4, "vacuous, expected proved"),
        (contradictory("REFUTED"), 1, "must fail, but is vacuous"),
        (contradictory("VACUOUS"), 0, "exit 0"),
        (NO_MEMORY, 3, "why: z3 broke down: out of memory; give -j 1, or the claim a smaller bound"),
    ],
)
def test_exit_codes_and_what_the_others_get(
    run: Run, project: Path, monkeypatch: pytest.MonkeyPatch, body: str, code: int, said: str
) -> None:
    monkeypatch.setattr(search, "Solver", search.Solver)  # put back what NO_MEMORY changes
    put(project, "proofs/bad.py", HEAD + body)
    called = run("prove", "-q", "-j", "2", "-k", "bad or five", "--json", "out.json")
    assert (called.code, said in called.err) == (code, True), called.err
    assert "Traceback" not in called.err
    assert "counter.five_is_far" in {entry["id"] for entry in document(project / "out.json")["claims"]} or code == 3


def test_what_was_found_before_an_interrupt_is_taken_by_the_next_run(run: Run, project: Path) -> None:
    slow = """
    @claim(Counter, expect=PROVED)
    def one(s: Seen) -> Bit:
        '''A claim.'''
        if os.path.exists("wait"):
            open("busy", "w").close()
            time.sleep(600)
        return s.n <= 15
    """
    put(project, "proofs/slow.py", HEAD + slow)
    put(project, "wait", "")
    start = "import sys; from safety.commands import main; sys.exit(main())"
    command = subprocess.Popen(
        [sys.executable, "-c", start, "prove", "-q", "-j", "2", "-k", "slow or five"], cwd=project, text=True,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[2])}, stderr=subprocess.PIPE,
    )  # fmt: skip
    assert command.stderr is not None
    while not (project / "busy").exists() or "five" not in command.stderr.readline():
        assert command.poll() is None
    command.send_signal(signal.SIGINT)
    assert "1 of 2 have no result, the others are kept" in command.stderr.read()
    assert command.wait() == 130
    command.stderr.close()
    (project / "wait").unlink()
    assert run("prove", "-q", "-k", "slow or five", "--json", "out.json").code == 0
    entries = {entry["id"]: entry for entry in document(project / "out.json")["claims"]}
    assert {name: bool(entry.get("cached")) for name, entry in entries.items()} == {
        "counter.five_is_far": True,
        "slow.one": False,
    }
