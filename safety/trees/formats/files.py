"""Reading fault trees and studies from files, told apart by content, and writing them in several formats."""

from __future__ import annotations

import os
from collections.abc import Sequence
from fractions import Fraction

from safety.trees.as_written import Rational, TreeError, exact
from safety.trees.collector import paused
from safety.trees.tree import FaultTree

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from safety.trees.formats.draft import Draft
    from safety.trees.study import Study

LARGEST = 64 * 2**20  # bytes of one file
EXPECTED = "expected Open-PSA MEF XML, JSON, Aralia text or Galileo text"
WRITERS = {
    ".dag": ("aralia_text", "to_aralia"),
    ".txt": ("aralia_text", "to_aralia"),
    ".dft": ("galileo", "to_galileo"),
    ".dot": ("dot", "to_dot"),
    ".gv": ("dot", "to_dot"),
}
Path = str | os.PathLike[str]


@paused()
def read(*paths: Path, top: str | None = None, mission_time_h: Rational | None = None) -> FaultTree:
    """The fault tree in `paths`: Open-PSA MEF XML (one file or several, trees and data apart), or one file of JSON,
    Aralia text or Galileo text. Common cause groups and substitutions are applied (see Study.quantified).

    `top` chooses the top gate where the file leaves it open; `mission_time_h` (hours) is for rates without a time of
    their own. Raises TreeError with file and line for anything malformed or that one static tree cannot hold, and for a
    file that cannot be read.
    """
    time = None if mission_time_h is None else exact(mission_time_h, "mission_time_h")
    texts = _texts(paths)
    try:
        return _draft(texts, time).finish(top)
    except RecursionError:
        raise _too_deep(texts) from None


@paused()
def read_study(*paths: Path, mission_time_h: Rational | None = None) -> Study:
    """Everything in `paths`, as `read` takes them. Raises TreeError."""
    time = None if mission_time_h is None else exact(mission_time_h, "mission_time_h")
    texts = _texts(paths)
    try:
        return _draft(texts, time).study()
    except RecursionError:
        raise _too_deep(texts) from None


def _texts(paths: Sequence[Path]) -> list[tuple[str, bytes]]:
    if not paths:
        raise TreeError("no file given; give a fault tree in Open-PSA MEF XML, JSON, Aralia text or Galileo text")
    texts = []
    for path in paths:
        file = str(os.fspath(path))
        try:
            with open(file, "rb") as stream:
                size = os.fstat(stream.fileno()).st_size  # 0 for a pipe
                content = stream.read(LARGEST + 1) if size <= LARGEST else b""
        except OSError as error:
            raise TreeError(f"{file}: cannot be read ({error.strerror}); correct the path") from None
        except ValueError:  # a NUL in the path
            raise TreeError(f"{file!r} is no path of a file; correct it") from None
        if max(size, len(content)) > LARGEST:
            raise TreeError(f"{file}: longer than {LARGEST >> 20} MB; split it into several files")
        texts.append((file, content))
    return texts


def _draft(texts: list[tuple[str, bytes]], time: Fraction | None) -> Draft:
    """What the texts say, by the reader of their format."""
    starts = [text.removeprefix(b"\xef\xbb\xbf").lstrip()[:1] for _, text in texts]
    if all(
        start == b"<" or text.startswith((b"\xff\xfe", b"\xfe\xff"))
        for start, (_, text) in zip(starts, texts, strict=True)
    ):
        from safety.trees.formats.mef import read_mef
        from safety.trees.formats.xml_elements import parse

        return read_mef([parse(text, file) for file, text in texts], time)
    if len(texts) > 1:
        files = ", ".join(file for file, _ in texts)
        raise TreeError(f"{files}: several files, and not all of them MEF; give MEF files only, or one file")
    [(file, text)] = texts
    if starts == [b"{"]:
        from safety.trees.formats.json_form import read_json

        return read_json(text, file, time)
    from safety.trees.formats.galileo import is_galileo

    if is_galileo(text):
        return _galileo(text, file, time)
    from safety.trees.formats.aralia_text import is_aralia, read_aralia

    if is_aralia(text):
        return read_aralia(text, file, time)
    raise TreeError(f"{file}:1: starts with {text[:20]!r}, {EXPECTED}; convert it to one of them")


def _galileo(text: bytes, file: str, time: Fraction | None) -> Draft:
    """The static tree in a Galileo text."""
    from safety.trees.formats.draft import Draft, at
    from safety.trees.formats.galileo import read_galileo

    with at(file):
        tree = read_galileo(text, file).static(time)
    draft = Draft(file, tree.name, tree.top, tree.description, tree.mission_time_h)
    draft.gates, draft.events, draft.house_events = list(tree.gates), list(tree.events), list(tree.house_events)
    return draft


def _too_deep(texts: list[tuple[str, bytes]]) -> TreeError:
    files = ", ".join(file for file, _ in texts)
    return TreeError(f"{files}: nested too deeply; give inner formulas names of their own")


def write(tree: FaultTree | Study, path: Path) -> None:
    """Write `tree`, or a whole study, in UTF-8 in the format that the ending of `path` says (see `text`).

    Raises TreeError for what the format cannot hold, OSError.
    """
    written = text(tree, os.path.splitext(os.fspath(path))[1].lower())
    try:
        content = written.encode()
    except UnicodeEncodeError as error:
        raise TreeError(
            f"a name or label holds {error.object[error.start]!r}, which no file can hold; remove it"
        ) from None
    with open(path, "wb") as stream:
        stream.write(content)


def text(tree: FaultTree | Study, ending: str) -> str:
    """`tree` in the format that goes with `ending`: .json (also where it is unknown), .xml or .mef (Open-PSA MEF), .dag
    or .txt (Aralia text), .dft (Galileo), .dot or .gv (Graphviz). `read` takes all but the last back.

    Raises TreeError for what the format cannot hold. Only JSON holds everything; MEF leaves out the mission time.
    """
    if ending in (".xml", ".mef"):
        from safety.trees.formats import mef_write

        return mef_write.tree_to_mef(tree) if isinstance(tree, FaultTree) else mef_write.study_to_mef(tree)
    if ending in WRITERS:
        if not isinstance(tree, FaultTree):
            raise TreeError(f"a study cannot be written as {ending}; write one of its trees, or .json or .xml")
        from importlib import import_module

        module, function = WRITERS[ending]
        return str(getattr(import_module(f"safety.trees.formats.{module}"), function)(tree))
    import json

    from safety.trees.formats.json_form import to_document

    return json.dumps(to_document(tree), ensure_ascii=False, indent=1) + "\n"
