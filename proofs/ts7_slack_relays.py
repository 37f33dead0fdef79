"""TS-7, said exactly: what relays, windows and verdicts of the common part do in one frame, wherever they stand.

For the same purpose as ts7_slack: the claims about times see a relay's counter or a window's memory only where much
later something comes of it; here each frame counts.  The variants differ in what is written out here for each.
Steps: a frame of 125 us.
Source: synchronisation, 2 out of 3 [P]; level rule, T_sync, relay times, rule (a), windows that settle, rule (b) [A].
"""

from __future__ import annotations

from models.ts7.voting import CommonPart, SettlingCommonPart
from proofs.ts7_brake_chain import CHANNELS
from proofs.ts7_slack import RELAYS
from safety import (
    PROVED,
    REFUTED,
    Bit,
    Scenario,
    Seen,
    UInt,
    all_of,
    any_of,
    bit,
    claim,
    count,
    implies,
    previous,
    select,
)

LAST = 3999  # age of a window in its last frame


def drives(steps: int, **others: object) -> Scenario:
    """Supply, and all channels in service; then as `others` say."""
    return Scenario(steps, {"supply": True, **{f"{n}.drive": True for n in CHANNELS}} | others)


def waited_anew(s: Seen, relay: str) -> UInt:
    """What a relay has to have waited before the next frame: one frame more, or nothing where nothing is awaited."""
    waits = (s[relay].coil ^ s[relay].closed) & (s[relay].contact == s[relay].closed)
    return select(waits, s[relay].waited + 1, 0).low(10)


IN_AND_OUT = Scenario(1400, {"supply": lambda k: k < 700 or k >= 1000, **{f"{n}.drive": True for n in CHANNELS}})


@claim(CommonPart, expect=PROVED, requirement="TS7-12", source="relay times [A]", witness=IN_AND_OUT)
def relays_begin_anew(s: Seen) -> Bit:
    """A relay that has moved, or whose coil has turned back, begins anew to wait."""
    return all_of(*(s[r].waited == previous(waited_anew(s, r), 0) for r in RELAYS))


@claim(CommonPart, expect=REFUTED, requirement="TS7-12", twin_of=relays_begin_anew, scenario=IN_AND_OUT)
def relays_wait_while_there_is_supply(s: Seen) -> Bit:
    """A relay waits as long as its coil has current."""
    return all_of(*(implies(previous(s[r].coil, False), s[r].waited > 0) for r in RELAYS))


# --- windows --------------------------------------------------------------------------------------------------------


def brakes(s: Seen, n: str) -> Bit:
    """A channel brakes: its relay NBRR is down."""
    return ~s[n].nbrr_relay.contact


def out(s: Seen) -> Bit:
    """A channel is isolated, reports its fault or is out of service."""
    return any_of(*(s.sync[f"cut_{n}"] | s[n].fault | ~s[n].chr_relay.contact for n in CHANNELS))


def remembered(s: Seen, goes_on: Bit) -> Bit:
    """What a window holds is what came of the frame before, where it goes on as long as it may and the rule says."""
    window, braking = s.sync.window, count(*(brakes(s, n) for n in CHANNELS))
    opens = ~window.open & ~out(s) & (braking >= 1) & (braking <= 2)
    stays = window.open & ~out(s) & (window.age < LAST) & goes_on
    exact = [window.open == previous(opens | stays, False)]
    exact.append(window.age == previous(select(stays, (window.age + 1).low(13), 0), 0))
    for n in CHANNELS:
        first, seen, now = window[f"first_{n}"], window[f"seen_{n}"], brakes(s, n)
        exact.append(first == previous((opens & now) | (stays & first), False))
        exact.append(seen == previous((opens & now) | (stays & any_of(seen, now)), False))
    return all_of(*exact)


def judged(s: Seen, goes_on: Bit) -> Bit:
    """Just in a window's last frame the channel is isolated that has braked alone, or alone has not."""
    braked = {n: s.sync.window[f"seen_{n}"] | brakes(s, n) for n in CHANNELS}
    last = s.sync.window.open & ~out(s) & (s.sync.window.age >= LAST) & goes_on
    exact = []
    for n in CHANNELS:
        others = [braked[m] for m in CHANNELS if m != n]
        alone = select(braked[n], ~any_of(*others), all_of(*others))
        exact.append(s.sync[f"isolate_{n}"] == (last & alone))
    return all_of(*exact)


def someone_brakes(s: Seen) -> Bit:
    """Some channel brakes."""
    return any_of(*(brakes(s, n) for n in CHANNELS))


C_OPENS_THE_OTHERS_COME_AND_GO = drives(
    7000,
    **{
        "a.drive": lambda k: not (1500 <= k < 1800 or 5000 <= k < 5300),
        "b.drive": lambda k: not (900 <= k < 1200 or 5600 <= k < 5900),
        "c.drive": lambda k: not (600 <= k < 2200 or 6200 <= k < 6500),
    },
)
B_OPENS_AND_ENDS = drives(2000, **{"b.drive": lambda k: not 500 <= k < 900})
OPENED = 661  # frame in which the relay of a channel whose drive ends in frame 500 is down and the window is open
FAULT_IN_THE_LAST_FRAME = drives(6000, **{"b.drive": lambda k: k < 500, "c.fault": lambda k: k == OPENED + LAST})
A_SILENT = drives(6000, **{"b.drive": lambda k: k < 500, "c.drive": lambda k: k < 1500})


@claim(CommonPart, expect=PROVED, requirement="TS7-8", source="T_sync 0.5 s [A]",
       witness=C_OPENS_THE_OTHERS_COME_AND_GO)  # fmt: skip
def windows_remember_just_so(s: Seen) -> Bit:
    """A window says for how long it is open, who braked in its first frame, and who in any."""
    return remembered(s, bit(True))


@claim(CommonPart, expect=REFUTED, requirement="TS7-8", twin_of=windows_remember_just_so,
       scenario=C_OPENS_THE_OTHERS_COME_AND_GO)  # fmt: skip
def windows_forget(s: Seen) -> Bit:
    """Whom a window has seen to brake brakes now."""
    return all_of(*(implies(s.sync.window[f"seen_{n}"], brakes(s, n)) for n in CHANNELS))


@claim(CommonPart, expect=PROVED, requirement="TS7-8", source="[P] the channel that stands alone",
       witness=FAULT_IN_THE_LAST_FRAME)  # fmt: skip
def verdicts_come_just_so(s: Seen) -> Bit:
    """A window's last frame isolates who stands alone, unless another channel is out or reports its fault just then."""
    return judged(s, bit(True))


@claim(CommonPart, expect=REFUTED, requirement="TS7-8", twin_of=verdicts_come_just_so,
       scenario=FAULT_IN_THE_LAST_FRAME)  # fmt: skip
def a_fault_in_the_last_frame_comes_too_late(s: Seen) -> Bit:
    """A window's last frame isolates a channel that has braked alone, whatever the others report."""
    others = any_of(s.sync.window.seen_a, s.sync.window.seen_c, brakes(s, "a"), brakes(s, "c"))
    return implies((s.sync.window.age >= LAST) & s.sync.window.seen_b & ~others, s.targets.b)


@claim(CommonPart, expect=PROVED, requirement="TS7-14", source="[P] isolation for good", witness=A_SILENT)
def isolated_just_by_verdict_or_fault(s: Seen) -> Bit:
    """A target has dropped just where it had before, its channel reports a fault, or a verdict isolates it."""
    exact = []
    for n in CHANNELS:
        exact.append(s.targets[n] == any_of(s.sync[f"cut_{n}"], s[n].fault, s.sync[f"isolate_{n}"]))
        exact.append(s.sync[f"cut_{n}"] == previous(s.targets[n], False))
    return all_of(*exact)


@claim(CommonPart, expect=REFUTED, requirement="TS7-14", twin_of=isolated_just_by_verdict_or_fault, scenario=A_SILENT)
def who_is_silent_alone_stays(s: Seen) -> Bit:
    """Who is silent alone stays in service."""
    return ~s.targets.a


# --- variants -------------------------------------------------------------------------------------------------------


@claim(SettlingCommonPart, expect=PROVED, requirement="TS7-8", source="[A] a window ends with the last brake command",
       witness=C_OPENS_THE_OTHERS_COME_AND_GO)  # fmt: skip
def settling_windows_remember_just_so(s: Seen) -> Bit:
    """Where windows settle they remember the same, and bring a verdict only where somebody brakes in the last frame."""
    return remembered(s, someone_brakes(s)) & judged(s, someone_brakes(s))


@claim(SettlingCommonPart, expect=REFUTED, requirement="TS7-8", twin_of=settling_windows_remember_just_so,
       scenario=B_OPENS_AND_ENDS)  # fmt: skip
def settling_windows_remember_for_ever(s: Seen) -> Bit:
    """Where windows settle they remember as long as others do."""
    return remembered(s, bit(True))
