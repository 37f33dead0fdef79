"""The examples for continuous integration are valid YAML, and their commands are taken."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import Any

import pytest

from tests.commands.conftest import Run

TEXT = (Path(__file__).resolve().parents[2] / "docs/ci.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"^ *(?:- run: |- )?(rightside inject .*)$", TEXT, re.MULTILINE)


def test_there_are_commands() -> None:
    assert len(COMMANDS) == 6


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_is_taken(run: Run, whole: Path, command: str) -> None:
    words = shlex.split(re.sub(r"\$CI_NODE_INDEX/\$CI_NODE_TOTAL", "2/4", command))[1:]
    run("inject", "--write-baseline", "baseline.json", "--store", "first", "--executor", "serial")
    run("inject", "--store", "shards", "--shard", "1/4", "--executor", "serial")
    place = ["--store", "first"] * ("--store" not in words) + ["--executor", "serial"]
    called = run(*words, *place)
    asked = 0 if "--target-coverage" not in words else 1  # the small project detects no dangerous fault
    assert called.code == asked, called.err


def test_examples_are_valid() -> None:
    yaml: Any = pytest.importorskip("yaml", reason="PyYAML reads the examples")
    blocks = re.findall(r"```yaml\n(.*?)```", TEXT, re.DOTALL)
    assert [sorted(map(str, yaml.safe_load(block))) for block in blocks] == [
        ["True", "jobs", "name", "permissions"],  # YAML 1.1 reads `on` as true
        ["inject"],
        ["gate", "shard"],
    ]
