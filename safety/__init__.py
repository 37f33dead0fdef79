"""rightside: turn an executable model of fail-safe equipment into evidence.

The names that model and proof files need; they are imported when first used, so that starting a command costs nothing.
"""

from __future__ import annotations

import importlib

_HOME = {
    "safety.terms": (
        "Bit Int Real UInt U1 U2 U3 U4 U5 U6 U7 U8 U9 U10 U12 U14 U16 U20 U24 U32 all_of any_of at_least "
        "bit count implies real select word"
    ),
    "safety.model": ("Model assume parameter point power_up require"),
    "safety.system": ("ANY ModelError"),
    "safety.trace": ("run"),
    "safety.faults": ("ANY_TIME FROM_START INTERMITTENT TRANSIENT Fault any_of_faults at_most common_cause every"),
    "safety.kinds": (
        "bridge byzantine clock_fast clock_glitch clock_slow clock_stop dead delayed drift extra flip frozen "
        "intermittent memory_flip missing noise offset open_circuit oscillating power_dip reads slow_to_operate "
        "slow_to_release stuck swapped upset welded wired_and wired_or"
    ),
    "safety.prove.claims": (
        "BOUNDED PROVED REFUTED UNDECIDED VACUOUS BITS INTEGERS Scenario Seen age claim faulty has last "
        "new_fault once persists previous since struck total"
    ),
    "safety.prove.refinement": ("refines"),
    "safety.prove.hazards": ("hazard"),
    "safety.prove.written_for": ("written_for"),
}
_MODULE = {name: module for module, names in _HOME.items() for name in names.split()}
__all__ = [
    "ANY",
    "ANY_TIME",
    "BITS",
    "BOUNDED",
    "FROM_START",
    "INTEGERS",
    "INTERMITTENT",
    "PROVED",
    "REFUTED",
    "TRANSIENT",
    "U1",
    "U2",
    "U3",
    "U4",
    "U5",
    "U6",
    "U7",
    "U8",
    "U9",
    "U10",
    "U12",
    "U14",
    "U16",
    "U20",
    "U24",
    "U32",
    "UNDECIDED",
    "VACUOUS",
    "Bit",
    "Fault",
    "Int",
    "Model",
    "ModelError",
    "Real",
    "Scenario",
    "Seen",
    "UInt",
    "age",
    "all_of",
    "any_of",
    "any_of_faults",
    "assume",
    "at_least",
    "at_most",
    "bit",
    "bridge",
    "byzantine",
    "claim",
    "clock_fast",
    "clock_glitch",
    "clock_slow",
    "clock_stop",
    "common_cause",
    "count",
    "dead",
    "delayed",
    "drift",
    "every",
    "extra",
    "faulty",
    "flip",
    "frozen",
    "has",
    "hazard",
    "implies",
    "intermittent",
    "last",
    "memory_flip",
    "missing",
    "new_fault",
    "noise",
    "offset",
    "once",
    "open_circuit",
    "oscillating",
    "parameter",
    "persists",
    "point",
    "power_dip",
    "power_up",
    "previous",
    "reads",
    "real",
    "refines",
    "require",
    "run",
    "select",
    "since",
    "slow_to_operate",
    "slow_to_release",
    "struck",
    "stuck",
    "swapped",
    "total",
    "upset",
    "welded",
    "wired_and",
    "wired_or",
    "word",
    "written_for",
]

TYPE_CHECKING = False  # typing itself is not needed to start
if TYPE_CHECKING:
    from typing import Any

    from safety.faults import (
        ANY_TIME,
        FROM_START,
        INTERMITTENT,
        TRANSIENT,
        Fault,
        any_of_faults,
        at_most,
        common_cause,
        every,
    )
    from safety.kinds import (
        bridge,
        byzantine,
        clock_fast,
        clock_glitch,
        clock_slow,
        clock_stop,
        dead,
        delayed,
        drift,
        extra,
        flip,
        frozen,
        intermittent,
        memory_flip,
        missing,
        noise,
        offset,
        open_circuit,
        oscillating,
        power_dip,
        reads,
        slow_to_operate,
        slow_to_release,
        stuck,
        swapped,
        upset,
        welded,
        wired_and,
        wired_or,
    )
    from safety.model import (
        Model,
        assume,
        parameter,
        point,
        power_up,
        require,
    )
    from safety.prove.claims import (
        BITS,
        BOUNDED,
        INTEGERS,
        PROVED,
        REFUTED,
        UNDECIDED,
        VACUOUS,
        Scenario,
        Seen,
        age,
        claim,
        faulty,
        has,
        last,
        new_fault,
        once,
        persists,
        previous,
        since,
        struck,
        total,
    )
    from safety.prove.hazards import (
        hazard,
    )
    from safety.prove.refinement import (
        refines,
    )
    from safety.prove.written_for import (
        written_for,
    )
    from safety.system import (
        ANY,
        ModelError,
    )
    from safety.terms import (
        U1,
        U2,
        U3,
        U4,
        U5,
        U6,
        U7,
        U8,
        U9,
        U10,
        U12,
        U14,
        U16,
        U20,
        U24,
        U32,
        Bit,
        Int,
        Real,
        UInt,
        all_of,
        any_of,
        at_least,
        bit,
        count,
        implies,
        real,
        select,
        word,
    )
    from safety.trace import (
        run,
    )


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name not in _MODULE:
        raise AttributeError(f"module 'safety' has no attribute {name!r}")
    value = getattr(importlib.import_module(_MODULE[name]), name)
    globals()[name] = value
    return value
