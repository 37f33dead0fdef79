"""Results as text, and files that are whole or as before: what a command needs to write, and nothing more to import."""

from __future__ import annotations

import json
import math
import os
from json.encoder import encode_basestring

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from typing import Any


class ResultsError(ValueError):
    """A results document that cannot be used; the message has the file, the place in it and what was expected there."""

    exit_code = 2


def dumps(results: dict[str, Any]) -> str:
    """Keys sorted, one item a line, but short lists of plain values on one line."""
    try:
        text = _text(results, "") + "\n"
        text.encode()
    except (TypeError, ValueError) as bad:
        raise ResultsError(f"results: cannot be written as JSON: {bad}") from None
    return text


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a text file so that a reader sees the old text or the new one, never a part."""
    write_bytes(path, text.encode("utf-8"))


def write_bytes(path: str | os.PathLike[str], content: bytes) -> None:
    """The same for any file; a pipe or a device cannot be replaced, only written.

    Raises `OSError` with the name of the file, on a full disk too.
    """
    try:
        _write(os.fspath(path), content)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from error


def _write(path: str, content: bytes) -> None:
    if os.path.exists(path) and not os.path.isfile(path):
        with open(path, "wb") as file:
            file.write(content)
        return
    folder = os.path.dirname(path)
    if folder:
        os.makedirs(folder, exist_ok=True)
    temporary = beside(path)
    try:
        with open(temporary, "wb") as file:
            file.write(content)
        os.replace(temporary, path)
    except BaseException:
        if os.path.exists(temporary):
            os.unlink(temporary)
        raise


def beside(path: str) -> str:
    """A name in the folder of `path` that this process alone uses."""
    return os.path.join(os.path.dirname(path), f".{os.path.basename(path)[:200]}.{os.getpid()}")


def _text(value: Any, indent: str) -> str:
    deeper = indent + " "
    if isinstance(value, dict) and value:
        lines = (f"{deeper}{_plain(str(name))}: {_text(value[name], deeper)}" for name in sorted(value))
        return "{\n" + ",\n".join(lines) + f"\n{indent}}}"
    if isinstance(value, list | tuple) and any(isinstance(item, dict | list | tuple) for item in value):
        return "[\n" + ",\n".join(deeper + _text(item, deeper) for item in value) + f"\n{indent}]"
    return _plain(value)


def _plain(value: Any) -> str:
    kind = type(value)
    if kind is str:
        return encode_basestring(value)
    if kind is float and math.isinf(value) and value > 0:
        return '"inf"'
    if kind is int or (kind is float and math.isfinite(value)):
        return repr(value)
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
