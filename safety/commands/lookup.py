"""Models and faults by the names that people type."""

from __future__ import annotations

import ast
import re
from typing import Any

from safety.commands import CommandError
from safety.faults import ANY_TIME, FROM_START, TRANSIENT, Fault, Kind
from safety.kinds import makers
from safety.model import Model
from safety.project import Project
from safety.system import nearest

_FAULT = re.compile(r"(?P<kind>.+?)@(?P<points>[^:]+)(?::(?P<at>\d+)(?:\+(?P<ticks>\d+))?)?")


def model_named(project: Project, name: str) -> type[Model]:
    """The model of a name: `Channel`, or `ts7.channel.Channel` where several are called so.  Raises CommandError."""
    models = {full: model for full, model in project.models.items() if hasattr(model, "step")}
    hits = [full for full in models if full == name.removeprefix("models.")] or [
        full for full in models if full.endswith(f".{name}")
    ]
    if len(hits) == 1:
        return models[hits[0]]
    if hits:
        raise CommandError(f"several models are called {name!r}: {', '.join(hits)}; give one of these names")
    short = {full.rsplit(".", 1)[-1] for full in models}
    raise CommandError(f"no model {name!r} in {project.root / 'models'}; {nearest(name, short)}")


def fault(text: str) -> Fault:
    """`KIND@POINT`, with `:AT` and `+TICKS` if wanted, e.g. `stuck(1, bit=3)@ring:20+5`.  Raises CommandError."""
    found = _FAULT.fullmatch(text)
    if found is None:
        raise CommandError(
            f"--fault {text!r}: write KIND@POINT, KIND@POINT:AT or KIND@POINT:AT+TICKS, e.g. stuck(1)@trip:20"
        )
    at, ticks = (int(found[name]) if found[name] else None for name in ("at", "ticks"))
    onset = TRANSIENT if ticks is not None else FROM_START if at is None else ANY_TIME
    return Fault(_kind(found["kind"].strip(), text), found["points"].split("+"), onset, at or 0, ticks)


def _kind(text: str, whole: str) -> Kind:
    """A kind from its call in words; only names of kinds and plain values are read, nothing is executed."""
    try:
        return _made(ast.parse(text, mode="eval").body, whole)
    except (SyntaxError, ValueError, AttributeError):
        raise CommandError(
            f"--fault {whole!r}: {text!r} is no fault kind; write e.g. stuck(0), flip(bit=3), byzantine"
        ) from None


def _made(call: Any, whole: str) -> Kind:
    """The kind of a call; an argument is a plain value, or the call of another kind."""

    name, known = getattr(call, "func", call).id, makers()

    def value(argument: ast.expr) -> Any:
        kind = isinstance(argument, ast.Call) and getattr(argument.func, "id", None) in known
        return _made(argument, whole) if kind else ast.literal_eval(argument)

    args = [value(arg) for arg in getattr(call, "args", ())]
    keywords = {one.arg: value(one.value) for one in getattr(call, "keywords", ())}
    if name not in known:
        raise CommandError(f"--fault {whole!r}: there is no kind {name!r}; {nearest(name, known)}")
    try:
        return known[name](*args, **keywords)
    except TypeError as error:
        raise CommandError(f"--fault {whole!r}: {error}") from None
