"""The verdict on a name in print: the number of a figure that a sentence sends to, the spelling of a word."""

from __future__ import annotations

from collections.abc import Mapping

from safety.audit.verdict import CONFIRMED, INCONSISTENT, MISPRINT, NOT_DERIVABLE, Judged

REPLACED, LOST, ADDED, EXCHANGED = "one sign replaced", "one sign lost", "one sign added", "two neighbours exchanged"
ANOTHER = "the name of another thing"


def judge(printed: str, means: str, names: Mapping[str, str]) -> Judged:
    """Whether what is printed is the name of what is meant; `names` are those in use, each with what it stands for."""
    rightly = [name for name, thing in names.items() if thing == means]
    if printed in rightly:
        return Judged(CONFIRMED, f"{printed}: {means}")
    if not rightly:
        return Judged(NOT_DERIVABLE, "", f"no name of {means} is known")
    told = f"{printed}: {names.get(printed, 'the name of nothing')}"
    if len(rightly) == 1:
        slip = ANOTHER if printed in names else slipped(printed, rightly[0])
        if slip:
            return Judged(MISPRINT, rightly[0], told, rightly[0], slip, (f"{rightly[0]}: {means}",))
    return Judged(INCONSISTENT, " or ".join(rightly), told)


def slipped(printed: str, meant: str) -> str:
    """The one slip of the pen that makes the printed word of the one that was meant; empty where there is none."""
    start = next((n for n, (a, b) in enumerate(zip(printed, meant, strict=False)) if a != b), None)
    if start is None:
        start = min(len(printed), len(meant))
    rest, wanted = printed[start:], meant[start:]
    if rest[1:] == wanted[1:] and rest and wanted:
        return REPLACED
    if rest == wanted[1:] and wanted:
        return LOST
    if rest[1:] == wanted and rest:
        return ADDED
    return EXCHANGED if rest[:2] == wanted[1::-1] and rest[2:] == wanted[2:] and len(rest) > 1 else ""
