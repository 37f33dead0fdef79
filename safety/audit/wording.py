"""The verdict on words that give a direction: "n2E falls with Ts", "ΔV does not depend on α"."""

from __future__ import annotations

import re
from collections.abc import Mapping

from safety.audit.algebra import Answer, decide
from safety.audit.exceptions import AuditError
from safety.audit.formula import Relation, symbol
from safety.audit.symbols import Symbols
from safety.audit.verdict import CONFIRMED, INCONSISTENT, NOT_DERIVABLE, Judged

_SAYS = re.compile(r"([^\W\d][\w']*) (rises with|falls with|does not depend on) ([^\W\d][\w']*)")
SIGNS = {"rises with": ">", "falls with": "<", "does not depend on": "="}


def read(says: str) -> tuple[str, str, str]:
    """The quantity, the word and the symbol.  Raises AuditError."""
    found = _SAYS.fullmatch(says.strip())
    if found is None:
        raise AuditError(f"{says!r} cannot be read; write e.g. {', '.join(f'x {word} y' for word in SIGNS)!r}")
    return found[1], found[2], found[3]


def judge(says: str, symbols: Symbols, given: Mapping[str, str], when: tuple[Relation, ...] = ()) -> Judged:
    """Whether a quantity moves as is said when one symbol grows and the other free ones stay.

    Raises AuditError for words that cannot be read, or a quantity that the symbol is not part of.
    """
    quantity, word, over = read(says)
    symbols.check(given)
    symbols.units({quantity, over}.union(*(side.names for condition in when for side in condition.sides)))
    whole = symbols.expanded(symbol(quantity), given, values=False, keep=over)
    later = f"{over}_later"
    grown = whole.replaced({over: symbol(later)})
    conditions = [
        Relation(tuple(symbols.expanded(side, given, values=False, keep=over) for side in each.sides), each.signs)
        for each in when
    ]
    more = [*conditions, *(each.replaced({over: symbol(later)}) for each in conditions)]
    more.append(Relation((symbol(later), symbol(over)), (">",)))
    signed = symbols.signed | ({later} if over in symbols.signed else set())
    told = f"{quantity} = {whole}"
    if over not in whole.names:
        true = word == "does not depend on"
        return Judged(CONFIRMED if true else INCONSISTENT, told, "" if true else f"{over} does not stand in it")
    answers: dict[str, Answer] = {}
    for name, sign in SIGNS.items():
        answers[name] = decide(Relation((grown, whole), (sign,)), more, signed, [whole, grown])
        if answers[name].holds:
            break
    found = next((name for name, answer in answers.items() if answer.holds), "")
    if found == word:
        return Judged(CONFIRMED, told, agreed_by=answers[found].agreed_by)
    if found:
        note = f"{'in fact' if '=' in (SIGNS[word], SIGNS[found]) else 'reversed'}: {quantity} {found} {over}"
        return Judged(INCONSISTENT, told, note, agreed_by=answers[found].agreed_by)
    if any(answer.holds is None for answer in answers.values()):
        return Judged(NOT_DERIVABLE, told, "not decided")
    return Judged(INCONSISTENT, told, f"{quantity} neither rises nor falls with {over} throughout")
