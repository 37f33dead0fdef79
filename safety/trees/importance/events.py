"""Importance of every basic event, all of them in two passes over the diagrams.

Exact definitions, with P the probability of the top event, q that of the event, P1 = P(top | the event occurs) and
P0 = P(top | it does not):

    birnbaum                 P1 - P0, the derivative of P with respect to q
    criticality              q (P1 - P0) / P
    fussell_vesely           (P - P0) / P, the fraction of P that vanishes with the event
    diagnostic               P(event | top) = q P1 / P
    risk_achievement_worth   P1 / P
    risk_reduction_worth     P / P0, infinite when the top event cannot occur without the event

P is linear in each q, so Fussell-Vesely, so defined, is the same number as the criticality. The probability of the
cut sets with the event over P, which some tools print under that name, differs from it in terms of second order.

Sources: W. E. Vesely et al., NUREG/CR-3385 (1983), worths; Y. Dutuit and A. Rauzy, "Efficient algorithms to assess
component and gate importance in fault tree analysis", Reliability Engineering and System Safety 72 (2001), the
factors and their computation.
"""

from __future__ import annotations

import math

from safety.trees.record import Record

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from typing import Any


class Importance(Record):
    """The measures of one basic event (no unit; see the module). None where 0/0 leaves one without meaning.

    All are doubles, or all are rationals (an infinite one is a double).
    """

    event: str
    probability: Any
    birnbaum: Any
    criticality: Any
    fussell_vesely: Any
    diagnostic: Any
    risk_achievement_worth: Any
    risk_reduction_worth: Any


def measures(event: str, q: Any, top: Any, with_event: Any, without_event: Any, birnbaum: Any = None) -> Importance:
    """All measures of `event` from q, P, P1 and P0 (see the module), and P1 - P0 where it is known better."""
    if birnbaum is None:
        birnbaum = with_event - without_event
    if top == 0:
        return Importance(event, q, birnbaum, None, None, None, None, None)
    lost = q * birnbaum  # P - P0, without its cancellation
    return Importance(
        event,
        q,
        birnbaum,
        criticality=lost / top,
        fussell_vesely=lost / top,
        diagnostic=q * with_event / top,
        risk_achievement_worth=with_event / top,
        risk_reduction_worth=top / without_event if without_event else math.inf,
    )


def plain(measures: object) -> dict[str, Any]:
    """The measures of an event, a gate or a pair by name; an infinite one is the text "inf"."""
    return {key: "inf" if value == math.inf else value for key, value in vars(measures).items()}
