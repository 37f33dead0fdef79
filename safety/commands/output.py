"""Where data goes: stdout, a JSON file, a waveform; nothing is left half-written."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping

from safety.commands import CommandError

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from typing import Any


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
        from pathlib import Path

        save(dict(document), Path(target))


def write_plain(document: Mapping[str, Any], target: str) -> None:
    """The same for a document of another shape (list, run)."""
    from safety.report.files import write_text

    text = json.dumps(document, indent=1, ensure_ascii=False)
    if target == "-":
        data(text)
    else:
        write_text(target, text + "\n")


def write(path: str | os.PathLike[str], text: str) -> None:
    """Write a text file in one go."""
    from safety.report.files import write_text

    write_text(path, text)


def probe(path: str | os.PathLike[str]) -> None:
    """Refuse a file that cannot be written, before hours of work.  Raises CommandError."""
    from safety.report.files import beside

    name = os.fspath(path)
    if name == "-" or (os.path.exists(name) and not os.path.isfile(name) and not os.path.isdir(name)):
        return
    try:
        if os.path.isdir(name):
            raise IsADirectoryError(0, "it is a folder; give a file in it")
        folder = os.path.dirname(name)
        if folder:
            os.makedirs(folder, exist_ok=True)
        with open(beside(name), "xb"):
            pass
        os.unlink(beside(name))
    except OSError as error:
        raise CommandError(f"{name} cannot be written: {error.strerror}; give another place") from None
