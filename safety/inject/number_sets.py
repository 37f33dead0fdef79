"""Sets of numbers as short text: ranges, `0-31 35`, or where these are many the bits of the set, `bits:` in base64."""

from __future__ import annotations

import base64
import binascii
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Numbers = npt.NDArray[np.int64]

RANGES, LONGEST = 4_000, 100_000  # characters: from so many on bits are taken where they are fewer, and no text at all
BITS = "bits:"


def to_text(numbers: Numbers) -> str | None:
    """Ascending numbers as text, the same on every machine; None where that takes more than `LONGEST` characters."""
    import numpy as np

    if not len(numbers):
        return ""
    breaks = np.flatnonzero(np.diff(numbers) != 1)
    text = ""
    if 2 * len(breaks) <= LONGEST:
        firsts, lasts = numbers[np.r_[0, breaks + 1]], numbers[np.r_[breaks, len(numbers) - 1]]
        ends = zip(firsts.tolist(), lasts.tolist(), strict=True)
        text = " ".join(str(first) if first == last else f"{first}-{last}" for first, last in ends)
        if len(text) <= RANGES:
            return text
    there = np.zeros(int(numbers[-1]) + 1, dtype=np.bool_)
    there[numbers] = True
    bits = BITS + base64.b64encode(np.packbits(there).tobytes()).decode()
    return min((each for each in (text, bits) if each and len(each) <= LONGEST), key=len, default=None)


def from_text(text: str, below: int) -> Numbers:
    """The numbers that `to_text` wrote.

    Raises `ValueError` for any other text, and for numbers that are not below the limit.
    """
    import numpy as np

    if text.startswith(BITS):
        try:
            packed = base64.b64decode(text.removeprefix(BITS), validate=True)
        except binascii.Error as bad:
            raise ValueError(f"no base64: {bad}") from None
        numbers = np.flatnonzero(np.unpackbits(np.frombuffer(packed, dtype=np.uint8)))
        last = int(numbers[-1]) if len(numbers) else -1
    else:
        pairs = _pairs(text)
        last = pairs[-1][1] if pairs else -1
        if last < below:
            ranges = [np.arange(first, end + 1) for first, end in pairs]
            numbers = np.concatenate([np.empty(0, dtype=np.int64), *ranges])
    if last >= below:
        raise ValueError(f"it goes to {last}, but they are numbered 0 to {below - 1}")
    return numbers


def _pairs(text: str) -> list[tuple[int, int]]:
    found: list[tuple[int, int]] = []
    for part in text.split():
        first, dash, last = part.partition("-")
        if not (first.isdecimal() and (not dash or last.isdecimal())):
            raise ValueError(f"{part!r} is no range such as 0-31")
        pair = int(first), int(last if dash else first)
        if pair[0] > pair[1] or (found and pair[0] <= found[-1][1]):
            raise ValueError(f"{part!r} stands out of order")
        found.append(pair)
    return found
