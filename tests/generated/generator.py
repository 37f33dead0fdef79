"""Models drawn at random: families, seeds, cases.  The same family and seed give the same cases everywhere."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from random import Random

from tests.generated import counting, racing, shapes, sharing, timing
from tests.generated.case import Case, Family, named

FAMILIES: dict[str, Family] = {
    f.__name__: f
    for f in (
        *(counting.modulus, counting.accumulator, counting.divider, counting.sums, counting.rate),
        *(racing.race, racing.vote),
        *(timing.watchdog, timing.monostable, timing.hold_off, timing.reset, timing.window),
        *(sharing.latch, sharing.transfer, sharing.credit, sharing.queue, sharing.arbiter),
        *(shapes.peak, shapes.ring, shapes.gray),
    )
}


def cases(family: str, seed: int) -> list[Case]:
    """The cases of a family and a seed, named `family.seed.letter`."""
    drawn = FAMILIES[family](Random(f"{family} {seed}"))
    return [named(case, f"{family}.{seed}.{letter}") for letter, case in zip("abcdef", drawn, strict=False)]


def drawn(seeds: Iterable[int], families: Iterable[str] = FAMILIES) -> Iterator[Case]:
    """All cases of some seeds of some families."""
    for family in families:
        for seed in seeds:
            yield from cases(family, seed)
