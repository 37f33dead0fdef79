"""A task as straight-line C++ over bits: a vector holds one bit of 512 runs (256 with AVX2), a word is its bits.

A wire then costs an eighth of what it costs as a byte a run, and a word as much as before: an addition takes two
operations of three operands a bit, a choice one.
"""

from __future__ import annotations

from collections.abc import Iterator

from safety.terms.graph import Term
from tests.bench.injection_text import Register, Writer

NO, YES = "every(0)", "every(1)"


class Slices(Writer):
    """Writes each bit of each term once."""

    # --- gates, with constants folded ------------------------------------------------------------------------------

    def invert(self, x: str) -> str:
        return YES if x == NO else NO if x == YES else self._named("wire", f"~{x}")

    def both(self, x: str, y: str) -> str:
        if NO in (x, y):
            return NO
        return y if x == YES else x if y == YES else self._named("wire", f"{x} & {y}")

    def either(self, x: str, y: str) -> str:
        if YES in (x, y):
            return YES
        return y if x == NO else x if y == NO else self._named("wire", f"{x} | {y}")

    def differ(self, *wires: str) -> str:
        """Whether an odd number of them is true."""
        open_ = [w for w in wires if w not in (NO, YES)]
        odd = wires.count(YES) % 2 == 1
        if not open_:
            return YES if odd else NO
        x = open_[0] if len(open_) == 1 else self._named("wire", " ^ ".join(open_))
        return self.invert(x) if odd else x

    def most(self, x: str, y: str, z: str) -> str:
        """Whether two of three are true."""
        for first, second, third in ((x, y, z), (y, z, x), (z, x, y)):
            if third == NO:
                return self.both(first, second)
            if third == YES:
                return self.either(first, second)
        return self._named("wire", f"most({x}, {y}, {z})")

    def choose(self, c: str, x: str, y: str) -> str:
        if x == y:
            return x
        if YES in (x, y):
            return self.either(c, y) if x == YES else self.either(self.invert(c), x)
        if NO in (x, y):
            return self.both(self.invert(c), y) if x == NO else self.both(c, x)
        return self._named("wire", f"chosen({c}, {x}, {y})")

    # --- terms -----------------------------------------------------------------------------------------------------

    def size(self, t: Term) -> int:
        """Bits of a term, in two's complement where it can be below 0."""
        low, high = (0, 1) if t.sort.kind == "bit" else self.span(t)
        return high.bit_length() if low >= 0 else 1 + max(high.bit_length(), (-1 - low).bit_length())

    def bits(self, t: Term, size: int = 0) -> list[str]:
        """The bits of a term, the lowest first, or so many of them."""
        if t.uid not in self.sliced:
            own = self.size(t)
            if t.uid in self.varies:
                self.sliced[t.uid] = [f"q{t.uid}_{k}" for k in range(own)] if t.op == "var" else self.made(t, own)
            elif t.is_const:
                self.sliced[t.uid] = [YES if int(t.attr) >> k & 1 else NO for k in range(own)]
            else:
                x = self.plain(t)
                self.sliced[t.uid] = [self._named("wire", f"every({x} >> {k} & 1)") for k in range(own)]
        found = self.sliced[t.uid]
        above = found[-1] if t.sort.kind != "bit" and self.span(t)[0] < 0 else NO
        return (found + [above] * size)[: size or len(found)]

    @property
    def sliced(self) -> dict[int, list[str]]:
        """The bits written so far."""
        return self.__dict__.setdefault("_sliced", {})

    def made(self, t: Term, size: int) -> list[str]:
        """The bits of an operation."""
        if t.op in ("bit", "slice"):
            start, many = t.attr if t.op == "slice" else (t.attr, 1)
            return self.bits(t.args[0], start + many)[start:]
        if t.op in ("eq", "lt", "le"):
            wide = max(map(self.size, t.args))
            x, y = (self.bits(a, wide) for a in t.args)
            return [
                self.equal(x, y) if t.op == "eq" else self.carry([*map(self.invert, x)], y, YES if t.op == "le" else NO)
            ]
        if t.op == "clip":
            return self.clipped(t, size)
        args = [self.bits(a, size if a.sort.kind != "bit" else 1) for a in t.args]
        if t.op == "sub":
            return self.sum(args[0], [*map(self.invert, args[1])], YES)
        if t.op == "add":
            return self.sum(*args, NO)
        if t.op == "select":
            return [self.choose(args[0][0], x, y) for x, y in zip(*args[1:], strict=True)]
        if t.op == "point":
            return self.tapped(t, args[0])
        gate = {
            "not": self.invert, "cast": str, "and": self.both, "band": self.both,
            "or": self.either, "bor": self.either, "xor": self.differ, "bxor": self.differ,
        }[t.op]  # fmt: skip
        return [gate(*column) for column in zip(*args, strict=True)]

    def tapped(self, t: Term, healthy: list[str]) -> list[str]:
        """The bits of a point, where a fault may act."""
        names = [self._named("wire", x) for x in healthy]

        def masked(r: str) -> str:
            return " ".join(f"{x} = ({x} & held[{r}].keep[{k}]) ^ held[{r}].turn[{k}];" for k, x in enumerate(names))

        self.lines.append(self.at(t, masked))
        return names

    def sum(self, x: list[str], y: list[str], carry: str) -> list[str]:
        total = []
        for a, b in zip(x, y, strict=True):
            total.append(self.differ(a, b, carry))
            carry = self.most(a, b, carry)
        return total

    def carry(self, x: list[str], y: list[str], carry: str) -> str:
        for a, b in zip(x, y, strict=True):
            carry = self.most(a, b, carry)
        return carry

    def equal(self, x: list[str], y: list[str]) -> str:
        apart = NO
        for a, b in zip(x, y, strict=True):
            apart = self.either(apart, self.differ(a, b))
        return self.invert(apart)

    def clipped(self, t: Term, size: int) -> list[str]:
        """A number that is too large only, or below 0 only."""
        (x,), (low, high) = t.args, t.sort.bounds
        least, greatest = self.span(x)
        found = self.bits(x)
        assert low == 0 and high & (high + 1) == 0 and (least >= 0 or greatest <= high), (
            "the range of a word, left on one side"
        )
        if least < 0:
            there = self.invert(found[-1])
            return [self.both(there, k) for k in self.bits(x, size)]
        over = NO
        for k in found[size:]:
            over = self.either(over, k)
        return [self.either(over, k) for k in self.bits(x, size)]

    # --- the program -----------------------------------------------------------------------------------------------

    def seen(self, wire: Term) -> str:
        return self._named("wire", self.bits(wire)[0])

    def registers(self) -> Iterator[Register]:
        for s in self.states:
            start = self.starts[s.path]
            if s.var.uid not in self.varies:
                yield Register(f"q{s.var.uid}", "long", str(start), self.plain(s.next))
                continue
            for k, following in enumerate(self.bits(s.next, self.size(s.var))):
                yield Register(f"q{s.var.uid}_{k}", "wire", f"every({start >> k & 1})", following)
