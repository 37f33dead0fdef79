"""What can go wrong with a rate; every class carries the exit code of a command that it stops.

RateError              2   the input is wrong; the message names the value and the remedy
  UnitError            2   a text that is no number with a unit, or a unit of the wrong kind
  NotExact             2   a double or a negative number where an exact one is needed
  ChainError           2   a Markov chain that is not one: unknown state, self loop
    NotErgodic         2   a long-run figure asked of a chain that has none
  Unreachable          2   no rate meets the target of an inverse problem
  DeclarationError     2   a rate statement that is incomplete or declared twice
RoutesDisagree         6   two independent routes to one figure differ
NumericsFailed        70   a certified enclosure could not be made narrow enough
"""

from __future__ import annotations


class RateError(ValueError):
    """The input is wrong."""

    exit_code = 2


class UnitError(RateError):
    """A text that is no number with a unit, or a unit of the wrong kind."""


class NotExact(RateError):
    """A double or a negative number where an exact one is needed."""


class ChainError(RateError):
    """A Markov chain that is not one."""


class NotErgodic(ChainError):
    """A long-run figure asked of a chain that has none."""


class Unreachable(RateError):
    """No rate meets the target of an inverse problem."""


class DeclarationError(RateError):
    """A rate statement that is incomplete or declared twice."""


class RoutesDisagree(ArithmeticError):
    """Two independent routes to one figure differ."""

    exit_code = 6


class NumericsFailed(ArithmeticError):
    """A certified enclosure could not be made narrow enough."""

    exit_code = 70
