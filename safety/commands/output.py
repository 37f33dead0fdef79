"""Where data goes: stdout, a JSON file, a waveform; nothing is left half-written."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from safety.commands import CommandError


def data(text: str) -> None:
    """Print data on stdout; a reader that has gone away is no error."""
    try:
        print(text, flush=True)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def write_json(document: Mapping[str, Any], target: str) -> None:
    """Write a results document to a file, or to stdout for `-`."""
    from safety.report.results import dumps, save

    if target == "-":
        data(dumps(dict(document)).rstrip("\n"))
    else:
        save(dict(document), Path(target))


def write_plain(document: Mapping[str, Any], target: str) -> None:
    """The same for a document of another shape (list, run)."""
    from safety.report.files import write_text

    text = json.dumps(document, indent=1, ensure_ascii=False)
    if target == "-":
        data(text)
    else:
        write_text(Path(target), text + "\n")


def write(path: Path, text: str) -> None:
    """Write a text file in one go."""
    from safety.report.files import write_text

    write_text(path, text)


def probe(path: Path) -> None:
    """Refuse a file that cannot be written, before hours of work.  Raises CommandError."""
    if str(path) == "-" or (path.exists() and not path.is_file() and not path.is_dir()):
        return
    try:
        if path.is_dir():
            raise IsADirectoryError(0, "it is a folder; give a file in it")
        path.parent.mkdir(parents=True, exist_ok=True)
        trial = path.with_name(f".{path.name}.{os.getpid()}")
        trial.touch(exist_ok=False)
        trial.unlink()
    except OSError as error:
        raise CommandError(f"{path} cannot be written: {error.strerror}; give another place") from None
