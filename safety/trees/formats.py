"""Reading fault trees from files, told apart by content, and writing them in the project's own JSON (`json_form`)."""

from __future__ import annotations

import json
from pathlib import Path

from safety.trees.json_form import read_json, to_document
from safety.trees.mef import read_mef
from safety.trees.tree import FaultTree, Rational, TreeError, exact
from safety.trees.xml_elements import parse


def read(*paths: str | Path, top: str | None = None, mission_time_h: Rational | None = None) -> FaultTree:
    """The fault tree in `paths`: Open-PSA MEF XML (one file or several, trees and data apart) or one JSON file.

    `top` chooses the top gate where the file leaves it open; `mission_time_h` (hours) is for rates without a time of
    their own. Raises TreeError with file and line for anything malformed, OSError for a file that cannot be read.
    """
    if not paths:
        raise TreeError("no file given; give a fault tree in Open-PSA MEF XML or JSON")
    time = None if mission_time_h is None else exact(mission_time_h, "mission_time_h")
    texts = [(str(path), Path(path).read_bytes()) for path in paths]
    files = ", ".join(file for file, _ in texts)
    starts = [text.removeprefix(b"\xef\xbb\xbf").lstrip()[:1] for _, text in texts]
    try:
        if all(start == b"<" for start in starts):
            return read_mef([parse(text, file) for file, text in texts], time).finish(top)
        if starts == [b"{"]:
            return read_json(texts[0][1], texts[0][0], time).finish(top)
    except RecursionError:
        raise TreeError(f"{files}: nested too deeply; give inner formulas names of their own") from None
    for (file, text), start in zip(texts, starts, strict=True):
        if start not in (b"<", b"{"):
            raise TreeError(
                f"{file}:1: starts with {text[:20]!r}, expected Open-PSA MEF XML or JSON; convert it to one of them"
            )
    raise TreeError(f"{files}: several files, and JSON among them; give one JSON file, or MEF files only")


def write(tree: FaultTree, path: str | Path) -> None:
    """Write `tree` as JSON in UTF-8; `read` gives an equal tree back. Raises OSError."""
    Path(path).write_text(json.dumps(to_document(tree), ensure_ascii=False, indent=1) + "\n", encoding="utf-8")
