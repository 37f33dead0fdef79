"""Names in Open-PSA MEF: identifiers, and the rule by which any other name is written as one.

An identifier begins with a letter or _, goes on with letters, digits and _, and has single hyphens between. Every other
character of a name is written _xHHHH_ (or _xHHHHHHHH_), its code in hexadecimal digits, as SQL/XML (ISO/IEC 9075-14)
writes names; an underscore before what reads as such a code is written _x005F_.
"""

from __future__ import annotations

import re

from safety.trees.as_written import TreeError

LETTER = "A-Za-zÀ-ÖØ-öø-ɏ"
PLAIN = re.compile(f"[{LETTER}_][{LETTER}0-9_]*(?:-[{LETTER}0-9_]+)*")
CODE = re.compile("_x([0-9A-Fa-f]{8}|[0-9A-Fa-f]{4})_")
BEGINS, GOES_ON = re.compile(f"[{LETTER}_]"), re.compile(f"[{LETTER}0-9_]")


def encoded(name: str) -> str:
    """`name` as an identifier. Raises TreeError when it is empty."""
    if not name:
        raise TreeError("a name is empty, which MEF cannot hold; give it a name")
    if PLAIN.fullmatch(name) and not CODE.search(name):
        return name
    written: list[str] = []
    for place, letter in enumerate(name):
        fits = GOES_ON if written else BEGINS
        hyphen = letter == "-" and written and written[-1] != "-" and place + 1 < len(name)
        if CODE.match(name, place) or not (fits.match(letter) or hyphen):
            code = ord(letter)
            written.append(f"_x{code:04X}_" if code < 0x10000 else f"_x{code:08X}_")
        else:
            written.append(letter)
    return "".join(written)


def decoded(identifier: str) -> str:
    """The name that an identifier stands for."""
    return CODE.sub(_letter, identifier)


def _letter(found: re.Match[str]) -> str:
    code = int(found[1], 16)
    return chr(code) if code < 0xD800 or 0xDFFF < code < 0x110000 else found[0]
