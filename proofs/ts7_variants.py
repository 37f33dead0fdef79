"""TS-7, the variants of the common part: their windows of synchronisation, said exactly.

The variants are there for one claim each that fails or holds with them; what else they do is said here, so that a
change of their text is noticed (`rightside prove --mutants`).
Steps: a frame of 125 us.
Source: synchronisation [P]; level rule, T_sync, windows that settle, rule (b) [A].
"""

from __future__ import annotations

from models.ts7.voting import BothMustBrake, SettlingCommonPart
from proofs.ts7_brake_chain import CHANNELS
from safety import PROVED, REFUTED, Bit, Scenario, Seen, any_of, bit, claim, count, previous

LAST = 3999  # age of a window in its last frame
B_AND_C_LATE = Scenario(
    1200, {"supply": True, "a.drive": True, "b.drive": lambda k: k >= 700, "c.drive": lambda k: k >= 700}
)


def open_as_the_rule_says(s: Seen, goes_on: Bit) -> Bit:
    """A window is open in the frame after one in which it opens or goes on and nobody is isolated or out of service."""
    window, braking = s.sync.window, count(*(~s[n].nbrr_relay.contact for n in CHANNELS))
    over = any_of(*(s.sync[f"cut_{n}"] | s[n].fault | s.isolated[n] for n in CHANNELS))
    opens = ~window.open & (braking >= 1) & (braking <= 2)
    return window.open == previous(~over & (opens | (window.open & (window.age < LAST) & goes_on)), False)


def someone_brakes(s: Seen) -> Bit:
    """Some relay NBRR is down."""
    return any_of(*(~s[n].nbrr_relay.contact for n in CHANNELS))


@claim(SettlingCommonPart, expect=PROVED, requirement="TS7-8", source="[A] a window ends with the last brake command")
def window_settles(s: Seen) -> Bit:
    """A window opens where one or two brake, and ends after 4000 frames or when no channel brakes any more."""
    return open_as_the_rule_says(s, someone_brakes(s))


@claim(SettlingCommonPart, expect=REFUTED, requirement="TS7-8", twin_of=window_settles, scenario=B_AND_C_LATE)
def settling_window_lasts(s: Seen) -> Bit:
    """Where windows settle, they yet last for 4000 frames unless someone is isolated."""
    return open_as_the_rule_says(s, bit(True))


@claim(BothMustBrake, expect=PROVED, requirement="TS7-8", source="T_sync 0.5 s [A]")
def window_lasts_with_rule_b(s: Seen) -> Bit:
    """With rule (b) a window opens where one or two brake, and lasts for 4000 frames unless someone is isolated."""
    return open_as_the_rule_says(s, bit(True))


@claim(BothMustBrake, expect=REFUTED, requirement="TS7-8", twin_of=window_lasts_with_rule_b, scenario=B_AND_C_LATE)
def window_settles_with_rule_b(s: Seen) -> Bit:
    """With rule (b) a window ends when no channel brakes any more."""
    return open_as_the_rule_says(s, someone_brakes(s))
