"""TS-7 as it is delivered: what the parameters that other claims leave open are set to.

Most claims hold for every threshold error, wheel setting, relay time and length of a window; here the values as written
are claimed, so that another default would not go unnoticed (`rightside prove --mutants`).
Steps: a window of constant speed (thresholds), a frame of 125 us.
Source: lowering, words [D]; check word [R]; times, no error or offset, switch on 820 mm [A].
"""

from __future__ import annotations

from models.ts7.system import Ts7
from models.ts7.threshold import Thresholds
from models.ts7.train import Bench
from models.ts7.voting import CommonPart
from proofs.ts7_brake_chain import CHANNELS, RELEASE
from proofs.ts7_slack import OPERATE, RELAYS
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
    implies,
    once,
    previous,
    select,
    word,
)


@claim(Thresholds, expect=PROVED, requirement="TS7-3", source="f_v > f_p: brake [P]; no error as delivered [A]")
def brakes_just_above_the_limit_as_delivered(s: Seen) -> Bit:
    """Without errors every channel brakes by its own limit just where the speed is above that of the signal."""
    return all_of(*(s[f"brakes_{n}"] == (s.x > 0) for n in "abc"))


@claim(Thresholds, expect=REFUTED, requirement="TS7-3", twin_of=brakes_just_above_the_limit_as_delivered)
def brakes_at_the_limit_as_delivered(s: Seen) -> Bit:
    """Without errors every channel brakes at the limit too.  Equality holds the state."""
    return all_of(*(s[f"brakes_{n}"] == (s.x >= 0) for n in "abc"))


def four_words_lower(limit: UInt, datum: UInt, lowered: Bit) -> Bit:
    """The limit is the word, or 4 words less where it is lowered, 0 staying 0."""
    least = select(lowered, word(4, 8), 0)
    return limit.int() == select(datum < least, 0, datum.int() - least.int())


@claim(Bench, expect=PROVED, requirement="TS7-8", source="[D] 4 words lower; no offset as delivered [A]")
def limit_is_four_words_lower_as_delivered(s: Seen) -> Bit:
    """As delivered the limit is the signal's word, and 4 words less where it is lowered, 0 staying 0."""
    return four_words_lower(s.a.limit, s.word, s.lowered)


@claim(Bench, expect=REFUTED, requirement="TS7-8", twin_of=limit_is_four_words_lower_as_delivered)
def limit_is_three_words_lower_as_delivered(s: Seen) -> Bit:
    """As delivered the limit is 3 words less where it is lowered."""
    return implies(s.lowered & (s.word.int() >= 3), s.a.limit.int() == s.word.int() - 3)


@claim(Bench, expect=PROVED, requirement="TS7-11", source="[R] word 85; roll-back word 11 [A]")
def check_and_roll_back_count_by_their_words(s: Seen) -> Bit:
    """As delivered each frame adds 85 to J2 and 11 to J3, modulo 256."""
    added = (s.a.ring[f"j{w}"] == (previous(s.a.ring[f"j{w}"], 0) + datum).low(8) for w, datum in ((2, 85), (3, 11)))
    return implies(once(bit(True)), all_of(*added))


@claim(Bench, expect=REFUTED, requirement="TS7-11", twin_of=check_and_roll_back_count_by_their_words)
def check_and_roll_back_count_by_85(s: Seen) -> Bit:
    """Each frame adds 85 to J2 and to J3."""
    added = (s.a.ring[f"j{w}"] == (previous(s.a.ring[f"j{w}"], 0) + 85).low(8) for w in (2, 3))
    return implies(once(bit(True)), all_of(*added))


@claim(
    Ts7, expect=PROVED, requirement="TS7-8", source="[D] 4 words lower; no offset, switch on 820 mm as delivered [A]"
)
def limits_and_wheel_as_delivered(s: Seen) -> Bit:
    """As delivered every limit is its signal's word, 4 words less where it is lowered; a speed pulse adds 164 to J1."""
    limits = (four_words_lower(s[n].limit, s[f"lines_{n}"].word, s[n].lowered) for n in CHANNELS)
    before = {n: previous(s[n].ring.j1, 0) for n in CHANNELS}
    added = (
        s[n].ring.j1 == select(previous(s.axle.pulse, False), (before[n] + 164).low(8), before[n]) for n in CHANNELS
    )
    return all_of(*limits, implies(once(bit(True)), all_of(*added)))


@claim(Ts7, expect=REFUTED, requirement="TS7-8", twin_of=limits_and_wheel_as_delivered)
def j1_adds_its_word_in_every_frame(s: Seen) -> Bit:
    """As delivered each frame adds 164 to J1, whether a speed pulse comes or not."""
    return implies(once(bit(True)), s.a.ring.j1 == (previous(s.a.ring.j1, 0) + 164).low(8))


def lasts_4000_frames(sync: Seen) -> Bit:
    """No window grows older than 3999 frames, and only in that frame it brings a verdict."""
    return (sync.window.age <= 3999) & (~any_of(*(sync[f"isolate_{n}"] for n in CHANNELS)) | (sync.window.age == 3999))


@claim(CommonPart, expect=PROVED, requirement="TS7-12", source="T_sync 0.5 s [A]")
def window_as_delivered(s: Seen) -> Bit:
    """As delivered a window lasts for 4000 frames and brings its verdict in the last."""
    return lasts_4000_frames(s.sync)


@claim(CommonPart, expect=REFUTED, requirement="TS7-12", twin_of=window_as_delivered,
       scenario=Scenario(5000, {"supply": True, "a.drive": True}))  # fmt: skip
def window_lasts_3999_frames(s: Seen) -> Bit:
    """As delivered a window lasts for 3999 frames.  A frame longer."""
    return s.sync.window.age <= 3998


@claim(Ts7, expect=PROVED, requirement="TS7-12", source="relay times, T_sync 0.5 s, gap 50 ms [A]")
def times_as_delivered(s: Seen) -> Bit:
    """As delivered a relay moves where it has waited for 240 frames (160 to open), a window lasts for 4000 frames, and
    the change-over comes after 400 frames without inverter."""
    relays = [s.common[r] for r in RELAYS]
    due = [r.waited >= select(r.coil, OPERATE, word(RELEASE, 8)) for r in relays]
    moves = ((r.contact ^ r.closed) == ((r.coil ^ r.closed) & late) for r, late in zip(relays, due, strict=True))
    power = s.power
    gone = power.change_over == (~power["inverter"] & (power.missing + 1 >= 400))
    return all_of(*moves, lasts_4000_frames(s.common.sync), gone)


@claim(Ts7, expect=REFUTED, requirement="TS7-12", twin_of=times_as_delivered,
       scenario=Scenario(300, {"inverter": True}))  # fmt: skip
def relays_move_at_once(s: Seen) -> Bit:
    """As delivered the contact of EB follows its coil at once.  It takes its time."""
    return s.common.eb_relay.contact == s.common.eb_relay.coil
