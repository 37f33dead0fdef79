"""The command `rightside`: one module a verb, imported when that verb is called.

Human text goes to stderr, data to stdout.  Exit codes: 0 all as asked, 1 refuted or a target missed, 2 usage or input
error, 3 undecided, 4 weaker than asked, 5 nothing selected, 6 engines disagree, 70 internal error, 130 interrupted.
A verb's module has `EXAMPLES`, `add_arguments(parser)` and `run(args) -> exit code`; its docstring is its help.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import os
import shlex
import signal
import sys
from collections.abc import Sequence

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from typing import Any, NoReturn

VERBS = {
    "verify": "run everything below and write the report",
    "list": "what there is: claims, syntheses, campaigns, hazards, rates, figures, exhibits, models, points",
    "run": "run a model and show its signals",
    "prove": "prove or refute claims",
    "inject": "run fault-injection campaigns",
    "tree": "find cut sets and solve fault trees",
    "rate": "work out rates and mean times",
    "audit": "recompute the printed figures and equations of papers",
    "report": "write or check the report of the last results",
    "replay": "show again how a claim fails, what a fault does, how a hazard comes about",
    "check": "check certificates of proofs",
    "export": "write a claim for another tool: AIGER, BTOR2, SMT-LIB, VMT, Verilog",
    "doctor": "show which packages, engines and programs there are, and what is missing",
}
MODULES = {"list": "listing"}  # a module `list` would hide the built-in one here
# chosen with -k alone
CHOSEN = {"verify": "results", "prove": "claims", "inject": "campaigns", "rate": "rates", "audit": "figures"}
INPUT_ERROR, INTERNAL, INTERRUPTED = 2, 70, 130


def _width() -> int:
    """The width of help: that of the terminal, or as COLUMNS says."""
    with contextlib.suppress(ValueError, OSError):
        return max(40, int(os.environ.get("COLUMNS") or os.get_terminal_size().columns) - 2)
    return 78


_WIDTH = _width()


class CommandError(Exception):
    """The command cannot do what was asked; the message says what to do instead."""

    exit_code = INPUT_ERROR


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command line; returns its exit code."""
    words = list(sys.argv[1:] if argv is None else argv)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # a console that lacks a sign shows "?" instead of stopping the run
            stream.reconfigure(errors="replace")
    try:
        if not words or words[0] not in VERBS:
            return _without_verb(words)
        return _call(words[0], words[1:])
    except SystemExit as end:  # argparse ends this way
        return end.code if isinstance(end.code, int) else INPUT_ERROR


def _without_verb(words: list[str]) -> int:
    parser = argparse.ArgumentParser(
        prog="rightside",
        usage="rightside VERB ...",
        description="Proofs, fault injection, fault trees and reliability figures for fail-safe equipment.",
        epilog=_verbs()
        + "\n\n`rightside VERB --help` shows options and examples.  Without a network, nothing is missing.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="store_true", help="show the release and end")
    if words and not words[0].startswith("-"):
        import difflib

        near = difflib.get_close_matches(words[0], VERBS, n=1)
        parser.error(
            f"there is no verb {words[0]!r}; " + (f"did you mean {near[0]}?" if near else f"verbs: {', '.join(VERBS)}")
        )
    args, rest = parser.parse_known_args(words)
    if rest:
        parser.error(f"{rest[0]} stands before the verb; write `rightside VERB {rest[0]} ...`")
    if args.version:
        from safety.commands.versions import VERSION

        print(VERSION)
        return 0
    parser.print_help(sys.stderr)
    return INPUT_ERROR


def _verbs() -> str:
    return "verbs:\n" + "\n".join(f"  {verb:<8} {text}" for verb, text in VERBS.items())


def _call(verb: str, words: list[str]) -> int:
    before, whole = _end_like_ctrl_c(signal.SIGTERM), "--traceback" in words
    try:
        module: Any = importlib.import_module(f"safety.commands.{MODULES.get(verb, verb)}")
        args = _parsed(verb, _parser(verb, module), words)
        args.command = shlex.join(["rightside", verb, *words])
        code: int = module.run(args)
        sys.stdout.flush()
    except KeyboardInterrupt:
        print(f"rightside {verb}: interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:  # the reader, e.g. `head`, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except Exception as error:
        return _failed(verb, error, whole)
    finally:
        if before is not None:
            signal.signal(signal.SIGTERM, before)
    return code


def _parser(verb: str, module: Any) -> argparse.ArgumentParser:
    examples = "examples:\n" + "\n".join(f"  {line}" for line in module.EXAMPLES.strip().splitlines())
    parser = argparse.ArgumentParser(
        prog=f"rightside {verb}",
        description=module.__doc__,
        epilog=examples,
        formatter_class=_Help,
        allow_abbrev=False,
    )
    module.add_arguments(parser)
    parser.add_argument("--project", metavar="DIR", help="the project's folder (default: found from here upwards)")
    parser.add_argument("--traceback", action="store_true", help="show the whole way to an error")
    return parser


class _Help(argparse.RawDescriptionHelpFormatter):
    """As wide as the terminal; asked of the system, as argparse makes one for each argument and imports much for it."""

    def __init__(self, prog: str) -> None:
        super().__init__(prog, width=_WIDTH)


def _parsed(verb: str, parser: argparse.ArgumentParser, words: list[str]) -> argparse.Namespace:
    """The arguments, in any order; a name where none may stand is told how names are given."""
    args, rest = parser.parse_known_intermixed_args(words)
    name = next((word for word in rest if not word.startswith("-")), None)
    if name is not None and verb in CHOSEN and name == rest[0]:
        parser.error(f"{name!r} stands alone; choose {CHOSEN[verb]} with -k NAME")
    if rest:
        parser.error(f"unrecognized arguments: {shlex.join(rest)}; `rightside {verb} --help` shows what there is")
    return args


def _end_like_ctrl_c(number: int) -> Any:
    """Let a termination signal keep partial results too; the handler before, or None outside the main thread."""

    def stop(*_: object) -> NoReturn:
        raise KeyboardInterrupt

    with contextlib.suppress(ValueError):
        return signal.signal(number, stop)
    return None


def _failed(verb: str, error: Exception, whole: bool) -> int:
    """Say what went wrong in a line or two; the exit code that the error's class carries."""
    code = getattr(error, "exit_code", INPUT_ERROR if isinstance(error, OSError) else INTERNAL)
    text = f"{error.filename}: {error.strerror}" if isinstance(error, OSError) and error.filename else str(error)
    told = isinstance(error, ImportError) and hasattr(error, "exit_code")  # what is wrongly installed says what to do
    unexpected = code == INTERNAL and not told
    if unexpected:
        text = f"internal error, {type(error).__name__}: {text}"
    print(f"rightside {verb}: {text}", file=sys.stderr)
    if whole:
        import traceback

        traceback.print_exception(error)
    elif unexpected:
        print(
            "  This is a fault of rightside. Please report it, with what this command shows with --traceback.",
            file=sys.stderr,
        )
    return int(code)
