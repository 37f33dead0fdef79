"""Groups whose balises all stand on slots, read without jitter or scale error: fast enough to go through all codes.

Places are the bits of a whole number, the lowest one the first place.  W lies between 40 and 41 slots.
Source: COLLECT, GUARD and DECIDE as in `decoder` [A].
"""

from __future__ import annotations

from collections.abc import Iterator

from models.position.code import SPAN, Code
from models.position.decoder import FIVE

WINDOW = (1 << (SPAN + 1)) - 1
ENDS = 1 | 1 << SPAN


def group(code: Code, extra: int | None = None, lost: int | None = None) -> int:
    """The places of a group 2 spans from the lowest bit, one balise too many, one of the five (by its slot) lost."""
    places = sum(1 << slot for slot in (0, *code, SPAN) if slot != lost) << 2 * SPAN
    return places if extra is None else places | 1 << (extra + 2 * SPAN)


def read(places: int, guarded: bool = True) -> Iterator[tuple[int, Code]]:
    """Origin, in slots from the first place of the group, and code of every reading that is accepted."""
    origin = -2 * SPAN
    while places:
        skipped = (places & -places).bit_length() - 1
        places, origin = places >> skipped, origin + skipped
        seen = places & WINDOW
        length = chain(places) if guarded else SPAN + 1
        alone = not guarded or not places & ((1 << length) - 1) & ~WINDOW
        if alone and seen.bit_count() == FIVE and seen & ENDS == ENDS:
            yield origin, slots(seen)
        places, origin = places >> length, origin + length


def chain(places: int) -> int:
    """Length of what belongs together from the lowest bit on: up to W free of balises."""
    length = 1
    while following := places >> length & WINDOW >> 1:
        length += following.bit_length()
    return length


def slots(seen: int) -> Code:
    """The three places between the ends."""
    p, q, r = (n for n in range(1, SPAN) if seen >> n & 1)
    return p, q, r
