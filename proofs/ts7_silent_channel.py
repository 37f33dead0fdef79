"""TS-7, the whole equipment: how long a channel that never brakes stays unnoticed.

One step is one frame, 125 us.  A channel is silent while the other two brake, as voted, and it does not, all being in
service.  T_sync is anything from 2400 to 8000 frames, 4000 (0.5 s) as delivered.

Main results: silence ends in an isolation within 2 T_sync + 1 frames (8001, 1.0 s), whatever the channels do and
whenever they break; that is exact.  A channel silent since power-up is found sooner: overspeed of 4 words for the 4941
frames after which the other two have braked, T_sync and two frames more.
Source: the rule [P]; level rule, T_sync, relay times [A].
"""

from __future__ import annotations

from collections.abc import Iterator

from models.ts7.system import Ts7
from models.ts7.train import PER_WORD
from proofs.ts7_brake_chain import CHANNELS, Chain
from proofs.ts7_formulas import Formula, named
from proofs.ts7_synchronisation import (
    EVER,
    SIGNAL_65,
    SILENCE,
    ends_in_isolation,
    three,
    windows_in_order,
)
from safety import (
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Int,
    Scenario,
    Seen,
    age,
    all_of,
    any_of,
    any_of_faults,
    at_most,
    claim,
    faulty,
    implies,
    select,
    stuck,
)

T_SYNC = ["common.sync.frames"]


def of_common(lemma: Formula) -> Formula:
    """A lemma of the common part, in the whole equipment."""
    return named(lemma.__name__, lambda s: lemma(s.common))


def outputs(steps: int, **braking: list[tuple[int, int]]) -> Scenario:
    """Broken channels whose drive has AC but in these intervals of frames."""
    levels = {n: list(levels_of(steps, braking[n])) for n in CHANNELS}
    values = {f"{n}.output.level": levels[n].__getitem__ for n in CHANNELS}
    return Scenario(steps, {"inverter": True, "mg": True, "lines.s65": True}, {"common.sync.frames": 4000},
                    list(CHANNELS), values)  # fmt: skip


def levels_of(steps: int, braking: list[tuple[int, int]]) -> Iterator[bool]:
    """The level of an output: it changes in every frame in which there is AC."""
    level = False
    for k in range(steps):
        level ^= not any(first <= k < end for first, end in braking)
        yield level


LATE_SILENCE = outputs(
    15_000, a=[(1000, 1500), (2000, 2300), (5582, EVER)], b=[(1000, EVER)], c=[(1000, 5502)]
)  # silent just after a window opened that has seen it brake

LEMMAS = [of_common(lemma) for lemma in (windows_in_order, *SILENCE)]


@claim(Ts7, symbolic=T_SYNC, faults=at_most(3, "channel"), lemmas=LEMMAS, expect=PROVED, requirement="TS7-7",
       source="[P] 1.6; level rule [A]", witness=LATE_SILENCE)  # fmt: skip
def silence_is_found_within_two_windows(s: Seen) -> Bit:
    """Whatever the three channels do: silence for 2 T_sync + 1 frames (1.0 s) isolates somebody."""
    return ends_in_isolation(s.common, 2, 1)


@claim(Ts7, symbolic=T_SYNC, faults=at_most(3, "channel"), expect=REFUTED, requirement="TS7-7",
       twin_of=silence_is_found_within_two_windows, scenario=LATE_SILENCE)  # fmt: skip
def silence_is_found_a_frame_earlier(s: Seen) -> Bit:
    """Whatever the three channels do: silence for 2 T_sync frames isolates somebody."""
    return ends_in_isolation(s.common, 2, 0)


# --- from overspeed on ---------------------------------------------------------------------------------------------

NEVER_BRAKES = Fault(stuck(0), "c.comparator.latch", name="c never brakes")
CHAIN = Chain(words=4, blind=faulty, mute=faulty)


def c_is_in_service(s: Seen) -> Bit:
    """Power is there, the check of c counts right; c, if it never brakes, is in service with its relays up and has not
    been seen to brake, or somebody is isolated."""
    check, relays, window = s.c.check, s.common.c, s.common.sync.window
    counted = 256 * check["count"].int() + s.c.ring.j2.int() - 85 * check.frame.int()
    checked = ~check.faulty & (counted >= 0) & (counted <= 255)
    unseen = relays.chr_relay.closed & relays.nbrr_relay.closed & ~window.seen_c & ~window.first_c
    return ~s.power.standby & checked & (any_cut(s) | ~faulty(s, "c") | unseen)


def any_cut(s: Seen) -> Bit:
    """Somebody is isolated."""
    return any_of(*three(s.common.sync, "cut_"))


def others_are_in_service(s: Seen) -> Bit:
    """Channels a and b are in service, or somebody is isolated."""
    return any_cut(s) | (s.common.a.chr_relay.closed & s.common.b.chr_relay.closed)


def at_rest(s: Seen) -> Bit:
    """All in service and c not seen to brake; a and b brake or not, at any phases."""
    return c_is_in_service(s) & others_are_in_service(s) & windows_in_order(s.common) & all_of(
        *(lemma(s) for lemma in CHAIN.lemmas()))  # fmt: skip


LONGEST = CHAIN.voted + 8000 + 2  # frames


def overspeed_lasts(s: Seen) -> Int:
    """For how many frames the train has been 4 words too fast."""
    return age(CHAIN.overspeed(s), LONGEST).int()


def silent_once_others_braked(s: Seen) -> Bit:
    """Once a and b have braked, a window is open that c has not braked in, as old as the overspeed allows."""
    window, lasted = s.common.sync.window, overspeed_lasts(s)
    open_ = window.open & window.seen_a & window.seen_b & (window.age + CHAIN.voted + 1 >= lasted)
    in_step = CHAIN.since(s) == select(lasted < CHAIN.braked, lasted, CHAIN.braked)
    return in_step & (any_cut(s) | ~faulty(s, "c") | (lasted <= CHAIN.voted) | open_)


def power_on(s: Seen) -> Bit:
    """The inverter delivers."""
    return s.inverter


def noticed(s: Seen, frames: int) -> Bit:
    """If channel c never brakes, and the train has been too fast for these frames and T_sync, somebody is isolated."""
    long = CHAIN.overspeed(s) & (overspeed_lasts(s) + 1 >= s.common.sync.frames + frames)
    return implies(long & faulty(s, "c"), any_of(*three(s, "targets.")))


IN_SERVICE = {f"common.{n}_relay.closed": True for n in ("a.chr", "b.chr", "c.chr", "a.nbrr", "b.nbrr", "c.nbrr")}
FROM_REST = Scenario(
    LONGEST, {**SIGNAL_65, "speed": 142 * PER_WORD},
    {**IN_SERVICE, "common.sync.frames": 4000}, [NEVER_BRAKES.name],
)  # fmt: skip


@claim(Ts7, symbolic=T_SYNC, faults=any_of_faults([NEVER_BRAKES]), given=power_on, start=at_rest, anywhere=True,
       lemmas=[c_is_in_service, others_are_in_service, of_common(windows_in_order), *CHAIN.lemmas(),
               silent_once_others_braked], expect=PROVED, requirement="TS7-7", source="[D]",
       witness=FROM_REST)  # fmt: skip
def a_channel_that_never_brakes_is_noticed(s: Seen) -> Bit:
    """Channel c never brakes, 4 words (1.9 km/h) too fast for 4942 frames, T_sync and one: somebody is isolated."""
    return noticed(s, CHAIN.voted + 1)


@claim(Ts7, symbolic=T_SYNC, faults=any_of_faults([NEVER_BRAKES]), given=power_on, start=at_rest, anywhere=True,
       expect=REFUTED, requirement="TS7-7", twin_of=a_channel_that_never_brakes_is_noticed,
       scenario=FROM_REST)  # fmt: skip
def a_channel_that_never_brakes_is_noticed_in_a_quarter_of_that(s: Seen) -> Bit:
    """Channel c never brakes, 4 words too fast for T_sync and a quarter of the 4942 frames: somebody is isolated."""
    return noticed(s, CHAIN.voted // 4)
