"""Options that several verbs share."""

from __future__ import annotations

import argparse
import os
from argparse import ArgumentParser
from fractions import Fraction

from safety.project import Value


def add_json(parser: ArgumentParser) -> None:
    """--json."""
    parser.add_argument("--json", metavar="FILE", help="write the results as JSON; - is stdout")


def add_selection(parser: ArgumentParser) -> None:
    """-k, --req, --lf."""
    group = parser.add_argument_group("selection")
    group.add_argument(
        "-k", metavar="EXPRESSION", dest="keyword", default="",
        help="those whose id, model or requirement contains the words; with and, or, not, brackets as in pytest",
    )  # fmt: skip
    group.add_argument(
        "--req", metavar="ID", action="append", default=[], help="those for this requirement; may be repeated"
    )
    group.add_argument("--lf", action="store_true", help="those that were not as asked the last time (all, if none)")


def add_work(parser: ArgumentParser) -> None:
    """-x, -j, --timeout, --set, --no-progress, --json."""
    group = parser.add_argument_group("work")
    group.add_argument("-x", action="store_true", dest="first", help="stop at the first result that is not as asked")
    group.add_argument("-j", metavar="N", type=_count, dest="jobs", help="worker processes (default: one a core)")
    group.add_argument("--timeout", metavar="SECONDS", type=_seconds, help="for one question to a solver (default: 60)")
    add_settings(group)
    group.add_argument("--no-progress", action="store_true", help="plain lines, even on a terminal")
    add_json(parser)


def add_settings(parser: argparse._ActionsContainer) -> None:
    """--set."""
    parser.add_argument(
        "--set", metavar="NAME=VALUE", action="append", default=[], dest="settings", type=setting,
        help="a parameter of the models: whole number, fraction (1/3, 0.5), true or false; may be repeated",
    )  # fmt: skip


def setting(text: str) -> tuple[str, Value]:
    """`name=value` with the value typed.  Raises ArgumentTypeError for anything else."""
    name, equals, value = text.partition("=")
    if not (name and equals):
        raise argparse.ArgumentTypeError(f"{text!r} is not NAME=VALUE")
    return name, typed(value)


def typed(text: str) -> Value:
    """true, false, a whole number (also 0x1f), or an exact fraction."""
    words: dict[str, Value] = {"true": True, "false": False}
    if text.lower() in words:
        return words[text.lower()]
    try:
        return int(text, 0)
    except ValueError:
        pass
    try:
        return Fraction(text)
    except (ValueError, ZeroDivisionError):
        raise argparse.ArgumentTypeError(
            f"{text!r} is no value: write a whole number, 1/3, 0.5, true or false"
        ) from None


def cores() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r}: give 1 or more")
    return int(text)


def _seconds(text: str) -> float:
    try:
        seconds = float(text)
    except ValueError:
        seconds = 0
    if not 0 < seconds < float("inf"):
        raise argparse.ArgumentTypeError(f"{text!r}: give seconds, more than 0")
    return seconds
