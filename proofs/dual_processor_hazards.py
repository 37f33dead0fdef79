"""Dual processors: minimal cut sets of "energised where the truth forbids it", over all that may fail around them.

Main results: three single faults, of which none is a fault of one processor: the wrong entry in the only source of line
data, one and the same fault in both processors, and the welded relay.  Two pairs: both processors broken independently,
and B, which drives the output, broken while the comparator says equal.  A comparator whose output stands, or that says
unequal, a lost clock and a lost supply are in no set.  Complete at every order over the listed faults, each one
replayed; that a broken A with a blind comparator is in none is due to B driving the output.
The pairs say nothing of order or time: a broken processor may show healthy words until the other breaks.  What that
makes of the rates, and what is left if it is found at once, stands in `dual_processor_rates`.
Wrong for three cycles in a row: an output that sticks gives the relay a last change (`an_output_at_1_brakes_at_once`).
"""

from __future__ import annotations

from collections.abc import Iterator

from models.dual_processor import OnBoard
from proofs.dual_processor import (
    EQUAL,
    REGISTERS,
    SAME_FAULT,
    SIGNAL_HIGH,
    SIGNAL_LOW,
    STANDING,
    WRONG_ENTRY,
    A,
    B,
    a_last_change_is_an_onset,
    near,
    output_stands,
    stands,
    was_twice_wrong,
    wrong,
)
from safety import ANY_TIME, Bit, Fault, Scenario, Seen, all_of, any_of, hazard, struck, stuck, welded

WELDED = Fault(welded(), ["dual.output.relay"], ANY_TIME, name="brake relay welded")
NO_SUPPLY = Fault(stuck(0), ["dual.output.supply"], ANY_TIME, name="no supply")
SINGLES = (WRONG_ENTRY.name, SAME_FAULT.name, WELDED.name)
PAIRS = ((A.name, B.name), (B.name, EQUAL.name))

ASSUMED = "[A] lambda, lambda_c, beta of the specification"
INVENTED = "[A] invented for the example"
RATES = {
    A.name: ("1e-5", ASSUMED), B.name: ("1e-5", ASSUMED), SAME_FAULT.name: ("1e-7", ASSUMED),
    EQUAL.name: ("1e-7", "[A] a tenth of lambda_c"), SIGNAL_HIGH.name: ("1e-7", "[A] a tenth of lambda_c"),
    SIGNAL_LOW.name: ("1e-7", "[A] a tenth of lambda_c"),
    **{fault.name: ("7e-7" if fault.name.endswith("unequal") else "1e-6", INVENTED) for fault in STANDING[2:]},
    NO_SUPPLY.name: ("1e-6", INVENTED), WELDED.name: ("1e-8", INVENTED), WRONG_ENTRY.name: ("1e-8", INVENTED),
}  # fmt: skip


def excused(s: Seen) -> Bit:
    """A cut set is there."""
    pairs = (all_of(*(struck(s, name) for name in pair)) for pair in PAIRS)
    return any_of(struck(s, *SINGLES), *pairs)


def the_command_is_right(s: Seen) -> Bit:
    """Lemma: while nothing stands still, B and the command are as the truth has them, and A unless it is broken."""
    b, a = (all_of(*(s.dual[n][name] == s.truth[name] for name in REGISTERS)) for n in "ba")
    right = b & (struck(s, A.name) | a) & (s.dual.output.command == s.truth.permit)
    return excused(s) | stands(s) | right


def a_last_change(s: Seen) -> Bit:
    """Lemma: wrong only by the last change of an output that sticks."""
    return excused(s) | a_last_change_is_an_onset(s)


def scenarios(present: tuple[str, ...]) -> Iterator[Scenario]:
    """Near a signal at stop, too fast; the faults strike."""
    yield near(*present)


@hazard(
    OnBoard, faults=[A, B, EQUAL, *STANDING, WRONG_ENTRY, SAME_FAULT, WELDED, NO_SUPPLY], scenarios=scenarios,
    lemmas=[output_stands, the_command_is_right, a_last_change], rates=RATES, hours="8760",
    requirement="AV-7", source="[D]", expect={1: 3, 2: 2},
)  # fmt: skip
def energised_where_the_truth_forbids(s: Seen) -> Bit:
    """The brake relay is energised for three cycles in which the truth forbids it."""
    return wrong(s) & was_twice_wrong(s)
