"""Where things lie in memory: the lanes of registers and masks, and the row of one step of the fault-free run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from safety.terms.column_bits import size_of
from safety.terms.graph import BIT, Term
from safety.terms.llvm import Target
from safety.terms.native import bytes_of, native_type

LINE = 64  # bytes of a line of the processor's cache, and of its widest vector


@dataclass(frozen=True)
class Block:
    """Lanes of terms one after the other, each from a whole line on but those of packed bits."""

    terms: Sequence[Term]
    target: Target

    @cached_property
    def offsets(self) -> Mapping[int, int]:
        """First byte of each term, by uid; the wide ones come first."""
        found: dict[int, int] = {}
        end = 0
        for term in sorted(self.terms, key=lambda t: -lane_bytes(t, self.target)):
            size = lane_bytes(term, self.target)
            end = -(-end // min(size, LINE)) * min(size, LINE)
            found[term.uid] = end
            end += size
        return found

    @cached_property
    def size(self) -> int:
        """Bytes of the block, in whole lines."""
        end = max((self.offsets[t.uid] + lane_bytes(t, self.target) for t in self.terms), default=0)
        least = 8 * self.target.lanes if self.target.sliced else LINE  # whole squares of planes
        return max(-(-end // least), 1) * least


def lane_bytes(term: Term, target: Target) -> int:
    """Bytes of all lanes of a term, 8 at least."""
    if target.sliced:
        return size_of(term.sort) * target.lanes // 8
    packed = term.sort == BIT and target.packed
    return max(target.lanes // 8 if packed else target.lanes * bytes_of(term), 8)


@dataclass(frozen=True)
class Row:
    """A step of the fault-free run as a record.

    `tally`: 0, or 1 when a measured frame ends with the step, 2 when its block does too; `block`: which that is;
    `frame`: the measured frame that ends next.  For each watched wire the first measured frame from here on at whose
    end it is true; then the registers before the step and what else is given, and the observed wires.
    """

    given: Sequence[Term]
    watched: int
    wires: int
    words: int = 0  # of the registers before the step as planes have them

    @cached_property
    def type(self) -> Any:
        """The NumPy dtype; `v0`, `v1`, ... are the terms, `next0`, ... and `wire0`, ... the wires."""
        import numpy as np

        fields: list[tuple[Any, ...]] = [("tally", np.int32), ("block", np.int32), ("frame", np.int32)]
        fields += [(f"next{i}", np.int32) for i in range(self.watched)]
        order = sorted(range(len(self.given)), key=lambda i: -bytes_of(self.given[i]))
        fields += [(f"v{i}", native_type(self.given[i])) for i in order]
        fields += [(f"wire{i}", np.uint8) for i in range(self.wires)]
        if self.words:
            fields.insert(0, ("record", np.uint64, (self.words,)))
        packed = np.dtype(fields)
        names, offsets = list(packed.names or ()), [packed.fields[n][1] for n in packed.names or ()]  # type: ignore[index]
        size = -(-packed.itemsize // 8) * 8
        formats = [packed.fields[n][0] for n in names]  # type: ignore[index]
        return np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": size})

    def offset(self, field: str) -> int:
        """Byte of a field."""
        found: int = self.type.fields[field][1]
        return found

    @cached_property
    def places(self) -> Mapping[int, int]:
        """Byte of each given term, by uid."""
        return {term.uid: self.offset(f"v{i}") for i, term in enumerate(self.given)}


def table(terms: Iterable[Term]) -> dict[int, Term]:
    """Terms by uid: `==` between terms is a term, not an answer."""
    return {term.uid: term for term in terms}
