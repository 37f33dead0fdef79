"""An and-inverter graph: variables, and-gates of two literals, inverters on the wires; hash-consed and folded.

A literal is 2 * n for node n and 2 * n + 1 for its inverse; node 0 is the constant, so 0 is false and 1 is true
(A. Biere, The AIGER And-Inverter Graph Format, 2007).  The rules that look one gate deep are those of R. Brummayer and
A. Biere, Local Two-Level And-Inverter Graph Minimization without Blowup, 2006, that make no gate of their own.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

FALSE, TRUE = 0, 1
Word = tuple[int, ...]
"""Literals of a number in two's complement, the lowest bit first."""


class Gates:
    """A graph that grows; `inputs[n]` are the two literals of gate n, None for a variable."""

    def __init__(self) -> None:
        self.inputs: list[tuple[int, int] | None] = [None]
        self._made: dict[tuple[int, int], int] = {}

    def variable(self) -> int:
        """The literal of a new variable."""
        self.inputs.append(None)
        return 2 * (len(self.inputs) - 1)

    def both(self, a: int, b: int) -> int:
        """a and b."""
        if a > b:
            a, b = b, a
        if a in (FALSE, b ^ 1):
            return FALSE
        if a in (TRUE, b):
            return b
        for x, y in ((a, b), (b, a)):
            gate = self.inputs[x >> 1]
            if gate is None:
                continue
            if not x & 1:
                if y in gate:
                    return x
                if y ^ 1 in gate:
                    return FALSE
            elif y ^ 1 in gate:
                return y
            elif y in gate:
                return self.both(y, gate[gate[0] == y] ^ 1)
        if (a, b) not in self._made:
            self.inputs.append((a, b))
            self._made[a, b] = 2 * (len(self.inputs) - 1)
        return self._made[a, b]

    def either(self, a: int, b: int) -> int:
        """a or b."""
        return self.both(a ^ 1, b ^ 1) ^ 1

    def differ(self, a: int, b: int) -> int:
        """a exclusive-or b."""
        return self.both(self.both(a, b) ^ 1, self.both(a ^ 1, b ^ 1) ^ 1)

    def choose(self, c: int, a: int, b: int) -> int:
        """a where c, else b."""
        if a == b:
            return a
        if a == b ^ 1:
            return self.differ(c, b)
        return self.both(self.both(c, a) ^ 1, self.both(c ^ 1, b) ^ 1) ^ 1

    def all_of(self, literals: Iterable[int]) -> int:
        """The conjunction, as a balanced tree."""
        level = list(literals) or [TRUE]
        while len(level) > 1:
            level = [self.both(*level[i : i + 2]) if i + 1 < len(level) else level[i] for i in range(0, len(level), 2)]
        return level[0]

    # --- words of one length ---------------------------------------------------------------------------------------

    def pick(self, c: int, x: Word, y: Word) -> Word:
        """The word x where c, else y."""
        return tuple(self.choose(c, a, b) for a, b in zip(x, y, strict=True))

    def add(self, x: Word, y: Word, carry: int = FALSE) -> Word:
        """The sum and the carry in, modulo 2 to the length."""
        total = []
        for a, b in zip(x, y, strict=True):
            half = self.differ(a, b)
            total.append(self.differ(half, carry))
            carry = self.either(self.both(a, b), self.both(half, carry))
        return tuple(total)

    def subtract(self, x: Word, y: Word) -> Word:
        """The difference, modulo 2 to the length."""
        return self.add(x, invert(y), TRUE)

    def multiply(self, x: Word, y: Word) -> Word:
        """The product, modulo 2 to the length."""
        if sum(b == FALSE for b in x) > sum(b == FALSE for b in y):  # a row for each bit that can be 1
            x, y = y, x
        total: Word = (FALSE,) * len(x)
        for i, bit in enumerate(y):
            row = (FALSE,) * i + tuple(self.both(bit, a) for a in x[: len(x) - i])
            total = self.add(total, row)
        return total

    def below(self, x: Word, y: Word) -> int:
        """x < y, both unsigned."""
        less = FALSE
        for a, b in zip(x, y, strict=True):
            less = self.choose(self.differ(a, b), b, less)
        return less

    def below_signed(self, x: Word, y: Word) -> int:
        """x < y, both in two's complement."""
        return self.below((*x[:-1], x[-1] ^ 1), (*y[:-1], y[-1] ^ 1))

    def same(self, x: Word, y: Word) -> int:
        """x = y."""
        return self.all_of(self.differ(a, b) ^ 1 for a, b in zip(x, y, strict=True))

    def divide(self, x: Word, divisor: int) -> tuple[Word, Word]:
        """Quotient and remainder of an unsigned word by a constant from 1 up, each as long as the word."""
        quotient: list[int] = []
        rest: Word = ()
        for bit in reversed(x):
            rest = (bit, *rest)[: divisor.bit_length() + 1]
            if len(rest) < divisor.bit_length():
                quotient.append(FALSE)
                continue
            by = constant(divisor, len(rest))
            fits = self.below(rest, by) ^ 1
            quotient.append(fits)
            rest = self.pick(fits, self.subtract(rest, by), rest)[: divisor.bit_length()]
        return tuple(reversed(quotient)), (*rest, *(FALSE,) * (len(x) - len(rest)))

    def cone(self, roots: Iterable[int]) -> list[int]:
        """The gates under some literals by number; a gate's number is above those of its inputs."""
        seen: set[int] = set()
        stack = [r >> 1 for r in roots]
        while stack:
            n = stack.pop()
            gate = self.inputs[n]
            if n not in seen and gate is not None:
                seen.add(n)
                stack += [a >> 1 for a in gate]
        return sorted(seen)


def constant(value: int, bits: int) -> Word:
    """A number in two's complement."""
    return tuple(value >> i & 1 for i in range(bits))


def invert(x: Sequence[int]) -> Word:
    """Every bit inverted."""
    return tuple(a ^ 1 for a in x)
