"""Show what there is to work with: Python packages, proof engines, programs on the path, and what is missing.

Ends with 2 where a package is missing that rightside needs, or where another distribution owns the package `safety`
too; a missing program only means that its engine does not take part.
"""

from __future__ import annotations

import platform
import re
import shutil
import subprocess
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

from safety.commands import INPUT_ERROR, options
from safety.commands.output import data, probe, write_plain
from safety.commands.table import table
from safety.commands.versions import ENGINES, VERSION

EXAMPLES = """
rightside doctor             what there is, what is missing, and how to install it
rightside doctor --json -    the same as data
"""
OURS = "rightside"
PATIENCE_S = 10
PROGRAMS = {  # how each tells its version, and the package that brings it
    "berkeley-abc": (["-q", "version"], "berkeley-abc"),
    "yosys": (["-V"], "yosys"),
    "cadical": (["--version"], "cadical"),
}


class Finding(NamedTuple):
    """One line: `state` is a version, `ready`, `missing` or `wrong`; `remedy` says what to do, if anything."""

    what: str
    name: str
    state: str
    remedy: str = ""


def add_arguments(parser: ArgumentParser) -> None:
    """Options of the verb."""
    options.add_json(parser)


def run(args: Namespace) -> int:
    """Carry out the verb."""
    if args.json:
        probe(Path(args.json))
    needed = [*_owners(), *_packages()]
    python = Finding("python", sys.executable, platform.python_version())
    found = [Finding("package", OURS, VERSION), python, *needed, *_engines(), *_programs()]
    if args.json:
        write_plain({"schema": "rightside/doctor/1", "found": [line._asdict() for line in found]}, args.json)
    else:
        data(table(["what", "name", "state", "remedy"], found))
    return INPUT_ERROR if any(line.remedy for line in needed) else 0


def _owners() -> Iterator[Finding]:
    """Other distributions that own a package called `safety`, most likely the scanner."""
    for name in sorted(set(metadata.packages_distributions().get("safety", [])) - {OURS}):
        yield Finding("package safety", name, "wrong", f"{sys.executable} -m pip uninstall {name}")


def _packages() -> Iterator[Finding]:
    """The packages that rightside asks for; run from its source it does not know them all, but what proofs need."""
    try:
        wanted = [text for text in metadata.requires(OURS) or [] if "extra ==" not in text]
    except metadata.PackageNotFoundError:
        wanted = [*ENGINES.values()]
    for text in sorted(wanted):
        name = re.split(r"[^\w.-]", text)[0]
        try:
            yield Finding("package", name, metadata.version(name))
        except metadata.PackageNotFoundError:
            yield Finding("package", name, "missing", f"{sys.executable} -m pip install '{text}'")


def _engines() -> Iterator[Finding]:
    from safety.prove.engines.engine import NAMES, engine

    for name in NAMES:
        missing = engine(name).unavailable()
        yield Finding("engine", name, "missing" if missing else "ready", missing or "")


def _programs() -> Iterator[Finding]:
    for name, (words, package) in PROGRAMS.items():
        path = shutil.which(name)
        if path is None:
            yield Finding("program", name, "missing", f"apt install {package} (Debian, Ubuntu)")
        else:
            yield Finding("program", name, _told([path, *words]))


def _told(command: list[str]) -> str:
    """The first line that a program prints of itself; `wrong` where it does not."""
    try:
        said = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=PATIENCE_S)
    except (OSError, subprocess.TimeoutExpired):
        return "wrong"
    lines = [line.strip() for line in (said.stdout + said.stderr).splitlines() if line.strip()]
    return lines[0] if lines else "wrong"
