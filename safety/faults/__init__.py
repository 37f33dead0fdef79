"""Faults, and the system that carries them.

A fault is a small machine at one or more points: from the healthy value it makes the value that is seen.  The same
machine serves a run, where a schedule says when it acts, and a proof, where the solver chooses; so what is simulated
and what is proved are the same fault.  No second, faulty copy of a model exists.

    Fault(stuck(1, bit=3), ["ring"])                          present from power-up for ever
    Fault(byzantine(), ["a.*"], onset=ANY_TIME)               every point of part a, from any step on
    Fault(flip(), ["a.latch"], onset=TRANSIENT, ticks=2)      up to two steps, once
    Fault(wired_or(), ["a.f_v", "b.f_v"])                     two lines that touch
    Fault(clock_stop(), ["a"], onset=ANY_TIME)                the registers of part a
"""

from safety.faults.budget import Budget, any_of_faults, at_most, every, expand
from safety.faults.fault import ANY_TIME, FROM_START, INTERMITTENT, ONSETS, TRANSIENT, Fault, common_cause
from safety.faults.instrument import PREFIX, Faulted, any_active, instrument, now_name, present_name, together
from safety.faults.places import Placed, is_wide, matching, placed, where
from safety.faults.runs import schedule, within
from safety.kinds import (
    Kind,
    Seat,
    byzantine,
    delayed,
    extra,
    flip,
    frozen,
    missing,
    open_circuit,
    stuck,
    welded,
)

__all__ = [
    "ANY_TIME", "FROM_START", "INTERMITTENT", "ONSETS", "PREFIX", "TRANSIENT",
    "Budget", "Fault", "Faulted", "Kind", "Placed", "Seat",
    "any_active", "any_of_faults", "at_most", "byzantine", "common_cause", "delayed", "every", "expand", "extra",
    "flip", "frozen", "instrument", "is_wide", "matching", "missing", "now_name", "open_circuit", "placed",
    "present_name", "schedule", "stuck", "together", "welded", "where", "within",
]  # fmt: skip
