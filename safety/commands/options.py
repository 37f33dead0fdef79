"""Options that several verbs share."""

from __future__ import annotations

import argparse
import os
from argparse import ArgumentParser
from fractions import Fraction

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
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


def add_work(parser: ArgumentParser, *, solvers: bool = True) -> None:
    """-x, -j, --timeout (where solvers are asked), --set, --no-progress, --json."""
    group = parser.add_argument_group("work")
    group.add_argument("-x", action="store_true", dest="first", help="stop at the first result that is not as asked")
    group.add_argument("-j", metavar="N", type=_count, dest="jobs", help="worker processes (default: one a core)")
    parser.set_defaults(timeout=None)
    if solvers:
        add_timeout(group)
    add_settings(group)
    group.add_argument("--no-progress", action="store_true", help="plain lines, even on a terminal")
    add_json(parser)


def add_timeout(parser: argparse._ActionsContainer) -> None:
    """--timeout."""
    parser.add_argument("--timeout", metavar="SECONDS", type=_seconds, help="for one question to a solver; default: 60")


def add_cache(parser: ArgumentParser) -> None:
    """--no-cache, --changed, --recheck."""
    group = parser.add_argument_group("results of earlier runs (.rightside/cache)")
    group.add_argument(
        "--no-cache", action="store_false", dest="cache", help="work everything out anew; read and keep no results"
    )
    group.add_argument("--changed", action="store_true", help="only what has no result of an earlier run")
    group.add_argument(
        "--recheck", metavar="SHARE[@SEED]", type=share, default=(Fraction(0), ""),
        help="prove this share of the claims with a result again (5%%, 1/20) and compare; another seed, other claims",
    )  # fmt: skip


def share(text: str) -> tuple[Fraction, str]:
    """A share with a seed: `5%`, `1/20@tuesday`.  Raises ArgumentTypeError for anything else."""
    amount, _, seed = text.partition("@")
    number, percent = amount.removesuffix("%"), amount.endswith("%")
    try:
        found = Fraction(number) / (100 if percent else 1)
    except (ValueError, ZeroDivisionError):
        found = Fraction(-1)
    if not 0 < found <= 1:
        raise argparse.ArgumentTypeError(f"{text!r}: give a share, more than 0 and at most 100%, e.g. 5% or 1/20")
    return found, seed


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
    from safety.project import exact

    words: dict[str, Value] = {"true": True, "false": False}
    if text.lower() in words:
        return words[text.lower()]
    try:
        return int(text, 0)
    except ValueError:
        pass
    try:
        return exact(text)
    except ValueError:
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
