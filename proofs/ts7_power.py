"""TS-7 power and relays: what is lost falls to the safe side, in how many frames, and what comes back.

One step is one frame, 125 us.  Relays release in 160 frames (20 ms) and operate in 240 (30 ms), the change-over to the
motor-generator takes 400 (50 ms).  In the claims about the common part the channels may do anything.
Source: always energised relays, loss of both sources, automatic change-over, dual fault, reverse [P]; times [A].

Main results: without supply NB and EB are there one frame after the release time; any opened coil, wire or contact
behind the vote brakes, in one channel it costs one vote; a change-over brakes for 1120 frames at most.
What is said of the change-over assumes that relays of a kind take equal times and that no channel is isolated
meanwhile: with unequal times power-up isolates a healthy channel, see
`ts7_isolation.nobody_isolated_at_power_up_with_unequal_relays`.
"""

from __future__ import annotations

from models.ts7.system import Ts7
from models.ts7.voting import CommonPart
from proofs.ts7_brake_chain import CHANNELS
from proofs.ts7_formulas import Formula, named
from safety import (
    ANY_TIME,
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
    at_least,
    claim,
    implies,
    once,
    open_circuit,
    persists,
    struck,
    stuck,
)

RELEASE, OPERATE, GAP = 160, 240, 400  # frames
BACK = GAP + 3 * OPERATE + 1  # frames from inverter failure to released brakes
RELAYS = ("nb_relay", "eb_relay", *(f"{n}.{r}_relay" for n in CHANNELS for r in ("chr", "nbrr")))
RUNS = {"lines.s65": True, "speed": 30 * 4096, "inverter": True, "mg": True}  # released after 720 frames


def falls(relay: Seen, since: Int) -> Bit:
    """The relay is open, or its release time has been running for so long."""
    return ~relay.closed | (relay.waited.int() >= since)


def rises(relay: Seen, since: Int) -> Bit:
    """The relay is closed, or its operate time has been running for so long."""
    return relay.closed | (relay.waited.int() >= since)


# --- loss of power -------------------------------------------------------------------------------------------------


def unpowered(s: Seen) -> Bit:
    """Neither the inverter nor the motor-generator delivers."""
    return ~s.inverter & ~s.mg


def outputs_fall(s: Seen) -> Bit:
    """NB and EB open, or their release time runs since both sources were lost."""
    lost = age(unpowered(s), 801).int()
    return falls(s.common.nb_relay, lost) & falls(s.common.eb_relay, lost)


def stops_without_power(s: Seen, spare: int) -> Bit:
    """Both sources lost for the longer of the release times and some spare frames: NB and EB."""
    lost, release = age(unpowered(s), 801).int() + 1, [s.common[f"{r}_relay"].release for r in ("nb", "eb")]
    return implies(unpowered(s) & all_of(*(lost >= r.int() + spare for r in release)), s.nb & s.eb)


RELEASES = ("common.nb_relay.release", "common.eb_relay.release")
POWER_FAILS = Scenario(1500, {**RUNS, "inverter": lambda k: k < 1000, "mg": False})


@claim(Ts7, symbolic=RELEASES, expect=PROVED, lemmas=[outputs_fall], requirement="TS7-15", source="[P] 1.7",
       witness=POWER_FAILS)  # fmt: skip
def stops_a_frame_after_the_release_time(s: Seen) -> Bit:
    """Loss of both sources, for any release times of NB and EB: both brakes one frame after these, whoever is isolated;
    no change-over gap adds to it."""
    return stops_without_power(s, 1)


@claim(Ts7, symbolic=RELEASES, expect=REFUTED, requirement="TS7-15", scenario=POWER_FAILS,
       twin_of=stops_a_frame_after_the_release_time)  # fmt: skip
def stops_at_the_release_time(s: Seen) -> Bit:
    """Loss of both sources, for any release times of NB and EB: both brakes after just these.  False: a frame later."""
    return stops_without_power(s, 0)


def on_the_generator(s: Seen) -> Bit:
    """Only the motor-generator delivers; the channels ask for no brake, none is isolated."""
    demands = any_of(*(~s[n].drive | s[n].rev | s[n].fault | s.common.sync[f"cut_{n}"] for n in CHANNELS))
    return s.mg & ~s.inverter & ~demands


def comes_back(s: Seen) -> Bit:
    """Change-over, CHR, NBRR and EB, NB: one after the other, each its time after the one before."""
    t = age(on_the_generator(s), BACK).int()
    power = s.power.standby | ((s.power.missing >= t) & (s.power.missing < GAP))
    supplied, in_service = t - GAP, t - GAP - OPERATE
    channels = [rises(s.common[n].chr_relay, supplied) & rises(s.common[n].nbrr_relay, in_service) for n in CHANNELS]
    last = rises(s.common.eb_relay, in_service) & rises(s.common.nb_relay, in_service - OPERATE)
    return (s.power.standby | (s.power.missing < GAP)) & ((t == 0) | power) & all_of(*channels) & last


INVERTER_FAILS = Scenario(3000, {**RUNS, "inverter": lambda k: k < 1000})


@claim(Ts7, expect=PROVED, lemmas=[comes_back], requirement="TS7-15", source="[P] automatic change-over; 50 ms [A]",
       witness=INVERTER_FAILS)  # fmt: skip
def inverter_loss_is_no_permanent_stop(s: Seen) -> Bit:
    """Inverter lost, motor-generator healthy, no channel asks for a brake or is isolated meanwhile, relays of a kind
    take equal times: released after 1121 frames (0.14 s)."""
    return implies(persists(on_the_generator(s), BACK), ~s.nb & ~s.eb)


@claim(Ts7, expect=REFUTED, requirement="TS7-15", scenario=INVERTER_FAILS, twin_of=inverter_loss_is_no_permanent_stop)
def inverter_loss_is_no_stop_of_1121_frames(s: Seen) -> Bit:
    """Inverter lost, motor-generator healthy, no channel asks for a brake or is isolated meanwhile, relays of a kind
    take equal times: released after 1120 frames.  False: NB is still applied then."""
    return implies(on_the_generator(s) & (age(on_the_generator(s), BACK) >= BACK - 2), ~s.nb & ~s.eb)


def all_up(s: Seen) -> Bit:
    """All relays are up; none has lost its coil for longer than the inverter has failed."""
    relays = [s.common[r] for r in RELAYS]
    waits = [r.closed & (r.waited <= s.power.gap) & (s.power.standby | (r.waited <= s.power.missing)) for r in relays]
    return all_of(*waits) & (s.power.standby | (s.power.missing < s.power.gap))


def gap_within(frames: int) -> Formula:
    """Change-over within so many frames, motor-generator healthy; no channel asks for a brake, none is isolated."""

    def given(s: Seen) -> Bit:
        demands = any_of(*(~s[n].drive | s[n].rev | s[n].fault | s.common.sync[f"cut_{n}"] for n in CHANNELS))
        return s.mg & ~demands & (s.power.gap <= frames)

    return named(f"motor-generator healthy, no demand from the channels, change-over within {frames} frames", given)


@claim(Ts7, given=gap_within(RELEASE), start=all_up, anywhere=True, symbolic=("power.gap",), expect=PROVED,
       lemmas=[all_up], requirement="TS7-15", source="[D] gap up to the release time")  # fmt: skip
def a_short_change_over_does_not_brake(s: Seen) -> Bit:
    """A change-over within the release time (160 frames, the same for all relays), no channel asks for a brake or is
    isolated meanwhile, however often the inverter fails: no brake at all."""
    return ~s.nb & ~s.eb


RELEASED = {
    **{f"{n}.comparator.latch": False for n in CHANNELS},
    **{f"common.{r}.closed": True for r in RELAYS},
}


@claim(Ts7, given=gap_within(RELEASE + 1), start=all_up, anywhere=True, symbolic=("power.gap",), expect=REFUTED,
       requirement="TS7-15", twin_of=a_short_change_over_does_not_brake,
       scenario=Scenario(300, {"lines.s65": True, "mg": True}, {"power.gap": 161, **RELEASED}))  # fmt: skip
def a_change_over_of_161_frames_does_not_brake(s: Seen) -> Bit:
    """A change-over within 161 frames, relays that all release in 160, no channel asks for a brake or is isolated
    meanwhile: no brake at all.  False: a gap of one frame more drops the relays."""
    return ~s.nb & ~s.eb


# --- open coils and broken wires -----------------------------------------------------------------------------------


def opens(*points: str) -> list[Fault]:
    """A broken wire, coil or contact at each point, at any time."""
    return [Fault(open_circuit(), [f"common.{p}"], ANY_TIME, name=f"{p} open") for p in points]


NO_SUPPLY = Fault(stuck(0), ["power.supply"], ANY_TIME, name="common supply lost")
BEHIND_THE_VOTE = [*opens("nb_relay.coil", "nb_relay.contact", "eb_relay.coil", "eb_relay.contact"), NO_SUPPLY]
IN_CHANNEL = {
    n: [
        *opens(*(f"{n}.{r}_relay.{p}" for r in ("nbrr", "chr") for p in ("coil", "contact"))),
        Fault(stuck(0), [f"common.{n}.supply"], ANY_TIME, name=f"supply of channel {n} lost"),
    ]
    for n in CHANNELS
}


def struck_for(s: Seen, faults: list[Fault], frames: int) -> Int:
    """For how many frames some of the faults has acted, before this one."""
    any_struck = struck(s, *(f.name for f in faults))
    return age(any_struck, frames).int() + any_struck.word().int()


def output_opens(s: Seen) -> Bit:
    """After a fault behind the vote, its relay is open, or its release time runs."""
    t = struck_for(s, BEHIND_THE_VOTE, RELEASE)
    nb = struck(s, "nb_relay.coil open", NO_SUPPLY.name) & falls(s.common.nb_relay, t)
    eb = struck(s, "eb_relay.coil open") & falls(s.common.eb_relay, t)
    return (t == 0) | nb | eb | struck(s, "nb_relay.contact open", "eb_relay.contact open")


NB_OPENS = Scenario(1500, RUNS, present=["nb_relay.coil open"], at=1000)


@claim(Ts7, faults=any_of_faults(BEHIND_THE_VOTE), expect=PROVED, lemmas=[output_opens], requirement="TS7-1",
       source="[P] always energised", witness=NB_OPENS)  # fmt: skip
def what_opens_behind_the_vote_brakes(s: Seen) -> Bit:
    """Coil open or broken wire of the voted NB or EB, or loss of the common supply: NB or EB within 161 frames."""
    return implies(struck_for(s, BEHIND_THE_VOTE, RELEASE) >= RELEASE, s.nb | s.eb)


@claim(Ts7, faults=any_of_faults(BEHIND_THE_VOTE), expect=REFUTED, requirement="TS7-1", scenario=NB_OPENS,
       twin_of=what_opens_behind_the_vote_brakes)  # fmt: skip
def what_opens_behind_the_vote_brakes_a_frame_earlier(s: Seen) -> Bit:
    """Coil open or broken wire of the voted NB or EB, or loss of the common supply: NB or EB within 160 frames.  False:
    the relay releases a frame later."""
    return implies(struck_for(s, BEHIND_THE_VOTE, RELEASE) >= RELEASE - 1, s.nb | s.eb)


def vote_falls(n: str) -> Formula:
    """Lemma: after a fault in the relays of channel n, NBRR is open or its release time runs, for CHR after its own."""
    coil, out, chr_coil, chr_out, supply = (fault.name for fault in IN_CHANNEL[n])

    def lemma(s: Seen) -> Bit:
        t, nbrr = struck_for(s, IN_CHANNEL[n], 2 * RELEASE), s.common[n].nbrr_relay
        at_once = struck(s, coil, chr_out, supply) & falls(nbrr, t)
        by_chr = struck(s, chr_coil) & falls(s.common[n].chr_relay, t) & falls(nbrr, t - RELEASE)
        return (t == 0) | at_once | by_chr | struck(s, out)

    return named(f"the vote of {n} falls", lemma)


def opened(s: Seen, n: str) -> Bit:
    """Something in channel n has been open for twice the release time."""
    return struck_for(s, IN_CHANNEL[n], 2 * RELEASE) >= 2 * RELEASE


A_OPENS = Scenario(1500, RUNS, present=["a.chr_relay.coil open"], at=1000)


@claim(Ts7, faults=any_of_faults([f for n in CHANNELS for f in IN_CHANNEL[n]]), expect=PROVED, requirement="TS7-1",
       lemmas=[vote_falls(n) for n in CHANNELS], source="[P] always energised; rule (a) [A]",
       witness=A_OPENS)  # fmt: skip
def what_opens_in_a_channel_votes_to_brake(s: Seen) -> Bit:
    """The same in any of the channels (relays NBRR, CHR, its supply): that channel votes to brake within 321 frames."""
    votes = all_of(*(~opened(s, n) | s.brakes[n] for n in CHANNELS))
    return implies(any_of(*(opened(s, n) for n in CHANNELS)), votes)


@claim(Ts7, faults=any_of_faults(IN_CHANNEL["a"]), expect=REFUTED, requirement="TS7-1", scenario=A_OPENS,
       twin_of=what_opens_in_a_channel_votes_to_brake)  # fmt: skip
def what_opens_in_a_channel_brakes_the_train(s: Seen) -> Bit:
    """What opens in channel a alone brakes the train within 321 frames.  False: one vote is not two."""
    return implies(opened(s, "a"), s.nb | s.eb)


# --- emergency brake -----------------------------------------------------------------------------------------------


def two_cut(s: Seen) -> Bit:
    """Two channels are isolated."""
    return at_least(2, *(s.sync[f"cut_{n}"] for n in CHANNELS))


def chain_opens(s: Seen) -> Bit:
    """Since two channels were isolated: their CHR fall, then the EB relay."""
    t = age(two_cut(s), 2 * RELEASE + 1).int()
    fallen = at_least(2, *(s.sync[f"cut_{n}"] & falls(s[n].chr_relay, t) for n in CHANNELS))
    return (t == 0) | (fallen & falls(s.eb_relay, t - RELEASE))


TWO_FAULTS = Scenario(1500, {"supply": True, "a.fault": lambda k: k == 1000, "b.fault": lambda k: k == 1000})


@claim(CommonPart, expect=PROVED, lemmas=[chain_opens], requirement="TS7-14", source="[P] dual fault, EB at once",
       witness=TWO_FAULTS)  # fmt: skip
def two_isolated_channels_apply_eb(s: Seen) -> Bit:
    """Two isolated channels: EB within 321 frames (40 ms), the release times of CHR and of EB."""
    return implies(two_cut(s) & (age(two_cut(s), 2 * RELEASE + 1) >= 2 * RELEASE), s.eb)


@claim(CommonPart, expect=REFUTED, requirement="TS7-14", scenario=TWO_FAULTS, twin_of=two_isolated_channels_apply_eb)
def two_isolated_channels_apply_eb_a_frame_earlier(s: Seen) -> Bit:
    """Two isolated channels: EB within 320 frames.  False: it takes a frame more."""
    return implies(two_cut(s) & (age(two_cut(s), 2 * RELEASE + 1) >= 2 * RELEASE - 1), s.eb)


@claim(CommonPart, expect=REFUTED, requirement="TS7-14", twin_of=two_isolated_channels_apply_eb,
       scenario=Scenario(1500, {"supply": True, "a.fault": lambda k: k == 1000}))  # fmt: skip
def one_isolated_channel_applies_eb(s: Seen) -> Bit:
    """One isolated channel applies EB.  False: it takes two."""
    cut = any_of(*(s.sync[f"cut_{n}"] for n in CHANNELS))
    return implies(persists(cut, 2 * RELEASE + 1), s.eb)


def rolls_back(s: Seen) -> Bit:
    """Some channel detects reverse motion."""
    return s.a.rev | s.b.rev | s.c.rev


def eb_falls(s: Seen) -> Bit:
    """The EB relay is open, or its release time runs since then."""
    return falls(s.common.eb_relay, age(rolls_back(s), RELEASE + 1).int())


BACKWARD = Scenario(3000, {**RUNS, "backward": lambda k: k >= 1000})
ONE_FINDS_IT = [Fault(stuck(0), [f"{n}.rev"], name=f"{n} never reports reverse") for n in "bc"]


@claim(Ts7, faults=any_of_faults(ONE_FINDS_IT), expect=PROVED, lemmas=[eb_falls], requirement="TS7-13",
       source="[P] OR over the channels", witness=BACKWARD)  # fmt: skip
def any_reverse_detection_applies_eb(s: Seen) -> Bit:
    """Any channel that detects reverse motion for 161 frames applies EB, even if the other two never do."""
    return implies(rolls_back(s) & (age(rolls_back(s), RELEASE + 1) >= RELEASE), s.eb)


@claim(Ts7, faults=any_of_faults(ONE_FINDS_IT), expect=REFUTED, requirement="TS7-13",
       twin_of=any_reverse_detection_applies_eb,
       scenario=Scenario(3000, BACKWARD.inputs, present=[f.name for f in ONE_FINDS_IT]))  # fmt: skip
def any_reverse_detection_applies_eb_a_frame_earlier(s: Seen) -> Bit:
    """Any channel that detects reverse motion for 160 frames applies EB.  False: it takes a frame more."""
    return implies(rolls_back(s) & (age(rolls_back(s), RELEASE + 1) >= RELEASE - 1), s.eb)


@claim(Ts7, expect=REFUTED, requirement="TS7-13", twin_of=any_reverse_detection_applies_eb,
       scenario=Scenario(6000, {**RUNS, "backward": lambda k: 1000 <= k < 3000}))  # fmt: skip
def eb_stays_once_applied_by_reverse_motion(s: Seen) -> Bit:
    """EB is held after reverse motion has ended.  False: not in this model, and not published."""
    return implies(once(rolls_back(s) & s.eb), s.eb)
