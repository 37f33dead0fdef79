"""TS-7, said exactly: what the parts do in one step, so that nothing else can stand in their text unnoticed.

The claims of the other files say what must not happen.  Where a change of the model leaves them all true
(`rightside prove --mutants`), the claim that tells it apart stands here, written another way than the model.
Steps: a window of constant speed, a frame of 125 us, a bit time of 3.90625 us.
Source: isolation of the channel that stands alone, lowering, AC drive [P]; rule (a), relay times, power-up [A].
"""

from __future__ import annotations

from models.ts7.power import Power
from models.ts7.ring import Ring
from models.ts7.signals import Selection
from models.ts7.system import Ts7
from models.ts7.threshold import Thresholds
from models.ts7.train import SCALE, Bench
from models.ts7.voting import CommonPart
from proofs.ts7_brake_chain import CHANNELS, RELEASE
from proofs.ts7_formulas import Formula, named
from proofs.ts7_thresholds import LIMITS
from proofs.ts7_voting import OFFSETS, too_fast
from safety import (
    ANY_TIME,
    PROVED,
    REFUTED,
    Bit,
    Fault,
    Scenario,
    Seen,
    UInt,
    age,
    all_of,
    any_of,
    at_most,
    bit,
    claim,
    count,
    implies,
    once,
    previous,
    select,
    stuck,
    word,
)


def in_force(s: Seen) -> list[Bit]:
    """Who brakes in a window: by its own limit, or, in a window of disagreement, by the lowered one."""
    own = [s[f"brakes_{n}"] for n in "abc"]
    opens = (count(*own) >= 1) & (count(*own) <= 2) & (count(s.cut_a, s.cut_b, s.cut_c) == 0)
    return [brake | (opens & s[f"follows_{n}"]) for brake, n in zip(own, "abc", strict=True)]


def stands_alone(s: Seen, n: str) -> Bit:
    """Nobody was isolated, the channels disagree, and one of them brakes or is silent all by itself."""
    braked = dict(zip("abc", in_force(s), strict=True))
    together = count(*braked.values())
    own = count(*(s[f"brakes_{m}"] for m in "abc"))
    opens = (own != 0) & (own != 3) & (count(s.cut_a, s.cut_b, s.cut_c) == 0)
    return opens & (((together == 1) & braked[n]) | ((together == 2) & ~braked[n]))


@claim(Thresholds, symbolic=LIMITS, expect=PROVED, requirement="TS7-8", source="[P] the channel that stands alone")
def just_who_stands_alone_is_isolated(s: Seen) -> Bit:
    """A window isolates the channel that stands alone at its end and no other; isolated once is isolated for ever."""
    return all_of(*(s.cut[n] == (s[f"cut_{n}"] | stands_alone(s, n)) for n in "abc")) & all_of(
        *(s[f"cut_{n}"] == previous(s.cut[n], False) for n in "abc")
    )


@claim(Thresholds, symbolic=LIMITS, expect=REFUTED, requirement="TS7-8", twin_of=just_who_stands_alone_is_isolated)
def a_silent_channel_is_never_isolated(s: Seen) -> Bit:
    """Only a channel that brakes alone is isolated, never one that is silent alone."""
    return all_of(*(implies(s.cut[n] & ~s[f"cut_{n}"], s.braked[n]) for n in "abc"))


@claim(Thresholds, symbolic=LIMITS, expect=PROVED, requirement="TS7-7", source="rule (a) [A]")
def brakes_just_by_rule_a(s: Seen) -> Bit:
    """NB comes just where two of three brake or are isolated, EB just where two are isolated."""
    votes = count(*(brake | s.cut[n] for brake, n in zip(in_force(s), "abc", strict=True)))
    return (s.nb == (votes >= 2)) & (s.eb == (count(*(s.cut[n] for n in "abc")) >= 2))


@claim(Thresholds, symbolic=LIMITS, expect=REFUTED, requirement="TS7-7", twin_of=brakes_just_by_rule_a)
def brakes_only_where_two_channels_brake(s: Seen) -> Bit:
    """NB comes just where two of three channels brake.  An isolated one counts as braking."""
    return s.nb == (count(*in_force(s)) >= 2)


# --- relays of the common part --------------------------------------------------------------------------------------

OPERATE = 240  # frames from coil to closed contact
RELAYS = (*(f"{n}.{r}_relay" for n in CHANNELS for r in ("chr", "nbrr")), "nb_relay", "eb_relay")


def waiting(s: Seen, relay: str) -> UInt:
    """For how many frames before this one the coil has differed from the contact, which has not moved since."""
    differs = s[relay].coil ^ s[relay].closed
    return age(differs & (s[relay].contact == s[relay].closed), 1023)


def waits(relay: str) -> Formula:
    """Lemma: what the relay has waited is that time, and never more than it operates in."""

    def lemma(s: Seen) -> Bit:
        return (s[relay].waited == waiting(s, relay)) & (s[relay].waited <= OPERATE)

    return named(f"{relay} waits", lemma)


@claim(CommonPart, expect=PROVED, lemmas=[waits(r) for r in RELAYS], requirement="TS7-12", source="relay times [A]")
def relays_move_just_in_time(s: Seen) -> Bit:
    """Open at power-up, a contact moves just in the frame in which its coil has differed for 30 ms (20 ms to open)."""
    moved = {r: s[r].contact ^ s[r].closed for r in RELAYS}
    due = {r: waiting(s, r) >= select(s[r].coil, OPERATE, word(RELEASE, 8)) for r in RELAYS}
    follows = all_of(*(moved[r] == ((s[r].coil ^ s[r].closed) & due[r]) for r in RELAYS))
    return follows & all_of(*(s[r].closed == previous(s[r].contact, False) for r in RELAYS))


@claim(CommonPart, expect=REFUTED, requirement="TS7-12", twin_of=relays_move_just_in_time,
       scenario=Scenario(300, {"supply": True}))  # fmt: skip
def relays_never_move(s: Seen) -> Bit:
    """No contact ever moves."""
    return all_of(*(s[r].contact == s[r].closed for r in RELAYS))


@claim(CommonPart, expect=PROVED, requirement="TS7-12", source="always-energised relays [P]")
def channel_relays_are_fed_just_so(s: Seen) -> Bit:
    """CHR has current just with supply and no isolation, NBRR just with supply, CHR up and the channel's drive."""
    up = {n: s[n].chr_relay.coil == (s[n].supply & ~s.sync[f"cut_{n}"]) for n in CHANNELS}
    runs = {n: s[n].nbrr_relay.coil == all_of(s[n].supply, s[n].chr_relay.contact, s[n].drive) for n in CHANNELS}
    return all_of(*up.values(), *runs.values(), *(s[n].supply == s.supply for n in CHANNELS))


@claim(CommonPart, expect=REFUTED, requirement="TS7-12", twin_of=channel_relays_are_fed_just_so)
def chr_needs_no_supply(s: Seen) -> Bit:
    """CHR has current just without isolation, whether there is supply or not."""
    return all_of(*(s[n].chr_relay.coil == ~s.sync[f"cut_{n}"] for n in CHANNELS))


SUPPLY_LOST = [Fault(stuck(0), [f"{n}.supply"], ANY_TIME, name=f"supply of {n} lost") for n in CHANNELS]


B_UNSUPPLIED = Scenario(
    1200, {"supply": True, **{f"{n}.drive": True for n in CHANNELS}}, present=["supply of b lost"], at=800
)


@claim(CommonPart, faults=at_most(2, SUPPLY_LOST), expect=PROVED, requirement="TS7-8", witness=B_UNSUPPLIED,
       source="no synchronisation after an isolation [P]")  # fmt: skip
def no_window_while_a_channel_is_out_of_service(s: Seen) -> Bit:
    """A frame after one or two CHR are down, be it for want of their own supply, there is no window."""
    return implies(previous(any_of(*(s.isolated[n] for n in CHANNELS)), False), ~s.synchronising)


@claim(CommonPart, expect=REFUTED, requirement="TS7-8", twin_of=no_window_while_a_channel_is_out_of_service,
       scenario=Scenario(1000, {"supply": True, "a.drive": True}))  # fmt: skip
def no_window_at_all(s: Seen) -> Bit:
    """There is never a window of synchronisation."""
    return ~s.synchronising


@claim(CommonPart, expect=PROVED, requirement="TS7-8", source="no synchronisation after an isolation [P]")
def no_verdict_beside_an_isolation(s: Seen) -> Bit:
    """A frame in which a channel is isolated, reports its fault or is out of service brings no verdict."""
    over = any_of(*(s.sync[f"cut_{n}"] | s[n].fault | s.isolated[n] for n in CHANNELS))
    return implies(over, ~any_of(*(s.sync[f"isolate_{n}"] for n in CHANNELS)))


@claim(CommonPart, expect=REFUTED, requirement="TS7-8", twin_of=no_verdict_beside_an_isolation,
       scenario=Scenario(5000, {"supply": True, "a.drive": True}))  # fmt: skip
def no_verdict_at_all(s: Seen) -> Bit:
    """No window ever brings a verdict."""
    return ~any_of(*(s.sync[f"isolate_{n}"] for n in CHANNELS))


@claim(CommonPart, expect=PROVED, requirement="TS7-12", source="always-energised relays [P]")
def brakes_just_where_a_contact_is_open(s: Seen) -> Bit:
    """NB and EB are there just where the contact of their relay is open."""
    return (s.nb ^ s.nb_relay.contact) & (s.eb ^ s.eb_relay.contact)


@claim(CommonPart, expect=REFUTED, requirement="TS7-12", twin_of=brakes_just_where_a_contact_is_open,
       scenario=Scenario(1000, {"supply": True, "a.drive": True, "b.drive": True, "c.drive": True}))  # fmt: skip
def brakes_for_ever(s: Seen) -> Bit:
    """NB and EB are there whatever the contacts do."""
    return s.nb & s.eb


# --- a channel ------------------------------------------------------------------------------------------------------


@claim(Bench, symbolic=["a.offset", "a.lowering"], expect=PROVED, requirement="TS7-8",
       source="[P] the level is lowered; offset, lowering [A]")  # fmt: skip
def limit_is_just_the_word(s: Seen) -> Bit:
    """The limit is the signal's word with the channel's offset, 0 staying 0, less the lowering where it is lowered."""
    exact, least = s.word.int() + s["a.offset"], select(s.lowered, s["a.lowering"].int(), 0)
    own = select(s.word == 0, 0, select(exact < 0, 0, select(exact > 255, 255, exact)))
    return s.a.limit.int() == select(own < least, 0, own - least)


@claim(Bench, expect=REFUTED, requirement="TS7-8", twin_of=limit_is_just_the_word)
def limit_is_always_the_word(s: Seen) -> Bit:
    """The limit is the signal's word, lowered or not."""
    return s.a.limit == s.word


@claim(Bench, expect=PROVED, requirement="TS7-12", source="[P] AC drive; toggle rate [A]")
def ac_just_while_it_may_run(s: Seen) -> Bit:
    """The output has AC just while the channel neither brakes nor has found itself faulty."""
    return s.drive == ~(s.brake | s.fault)


@claim(Bench, expect=REFUTED, requirement="TS7-12", twin_of=ac_just_while_it_may_run,
       scenario=Scenario(300, {"word": 200, "wheel": 164, "true_wheel": 164}))  # fmt: skip
def output_never_has_ac(s: Seen) -> Bit:
    """The output never has AC."""
    return ~s.drive


def at_power_up() -> Bit:
    """The first frame."""
    return ~once(bit(True))


@claim(Bench, expect=PROVED, requirement="TS7-12", source="[A] it powers up braking")
def powers_up_braking(s: Seen) -> Bit:
    """A channel powers up braking, three pulses ahead, its output low."""
    return implies(at_power_up(), (s.a.comparator.u == 3) & s.a.comparator.latch & ~s.a.output.level)


@claim(Bench, expect=REFUTED, requirement="TS7-12", twin_of=powers_up_braking,
       scenario=Scenario(300, {"word": 200, "wheel": 164, "true_wheel": 164}))  # fmt: skip
def stays_at_power_up(s: Seen) -> Bit:
    """A channel stays three pulses ahead."""
    return s.a.comparator.u == 3


@claim(Ring, expect=PROVED, requirement="TS7-1", source="[A] a frame begins at power-up")
def ring_powers_up_without_pulses(s: Seen) -> Bit:
    """At power-up no overflow pulse is held and the first bit of a frame comes."""
    return implies(at_power_up(), ~any_of(s.held0, s.held1, s.held2, s.held3) & (s.place == 0))


@claim(Ring, expect=REFUTED, requirement="TS7-1", twin_of=ring_powers_up_without_pulses)
def ring_stays_at_the_first_bit(s: Seen) -> Bit:
    """The first bit of a frame comes all the time."""
    return s.place == 0


# --- signals and power ----------------------------------------------------------------------------------------------

LINES = ("s0", "s25", "s45", "s65", "s75", "s90")  # from the lowest signal up
SHOWN = (0, 53, 95, 138, 159, 191)  # their words


def lowest(s: Seen, name: str) -> Bit:
    """The line is active and none of a lower signal is."""
    lower = LINES[: LINES.index(name)]
    return s.lines[name] & all_of(*(~s.lines[other] for other in lower))


@claim(Selection, expect=PROVED, requirement="TS7-2", source="[P] data matrix; the words [D]")
def lowest_signal_gives_its_word(s: Seen) -> Bit:
    """The word is just that of the lowest active line, and 0 where no line is active."""
    shown = (implies(lowest(s, name), s.word == datum) for name, datum in zip(LINES, SHOWN, strict=True))
    return all_of(*shown, implies(~any_of(*(s.lines[name] for name in LINES)), s.word == 0))


@claim(Selection, expect=REFUTED, requirement="TS7-2", twin_of=lowest_signal_gives_its_word)
def every_active_signal_gives_its_word(s: Seen) -> Bit:
    """The word is that of every active line.  Two may be active: the lower one wins."""
    return all_of(*(implies(s.lines[name], s.word == datum) for name, datum in zip(LINES, SHOWN, strict=True)))


def failed_for(s: Seen, gap: UInt | int) -> Bit:
    """The inverter has failed at some time before for the frames of the gap, in one piece."""
    return once(~s.inverter & (age(~s.inverter, 1023) + 1 >= gap))


def counts_any_gap(s: Seen) -> Bit:
    """Lemma: the counter is the time without inverter, the latch says that the gap has passed once."""
    return (s.missing == age(~s.inverter, 1023)) & (s.standby == failed_for(s, s.gap))


@claim(Power, symbolic=["gap"], expect=PROVED, lemmas=[counts_any_gap], requirement="TS7-15",
       source="automatic change-over [P]; it stays [A]")  # fmt: skip
def changes_over_once_just_after_the_gap(s: Seen) -> Bit:
    """From the inverter until it has failed for the gap, in one piece; from then on the motor-generator for ever."""
    return (s.supply == select(failed_for(s, s.gap), s.mg, s.inverter)) & (s.missing == age(~s.inverter, 1023))


@claim(Power, symbolic=["gap"], expect=REFUTED, requirement="TS7-15", twin_of=changes_over_once_just_after_the_gap)
def goes_back_to_the_inverter(s: Seen) -> Bit:
    """There is supply wherever the inverter delivers.  Once changed over, only the motor-generator counts."""
    return implies(s.inverter, s.supply)


def counts_400_frames(s: Seen) -> Bit:
    """Lemma: the same for the gap of 400 frames."""
    return (s.missing == age(~s.inverter, 1023)) & (s.standby == failed_for(s, 400))


@claim(Power, expect=PROVED, lemmas=[counts_400_frames], requirement="TS7-15", source="50 ms [A]")
def changes_over_after_400_frames(s: Seen) -> Bit:
    """As delivered the gap is 400 frames: 50 ms."""
    return s.supply == select(failed_for(s, 400), s.mg, s.inverter)


@claim(Power, expect=REFUTED, requirement="TS7-15", twin_of=changes_over_after_400_frames,
       scenario=Scenario(500, {"mg": True}))  # fmt: skip
def never_changes_over(s: Seen) -> Bit:
    """Without inverter there is no supply."""
    return implies(~s.inverter, ~s.supply)


# --- what connects the parts ----------------------------------------------------------------------------------------


@claim(Ts7, symbolic=OFFSETS, expect=PROVED, requirement="TS7-8", source="[P] the limits of the others are lowered",
       witness=too_fast(0, 3000, start={"b.offset": -4}))  # fmt: skip
def lowered_just_in_a_window_of_others(s: Seen) -> Bit:
    """A channel's limit is lowered just while a window is open that it did not open."""
    window = s.common.sync.window
    return all_of(*(s[n].lowered == ~(~window.open | window[f"first_{n}"]) for n in CHANNELS))


@claim(Ts7, symbolic=OFFSETS, expect=REFUTED, requirement="TS7-8", twin_of=lowered_just_in_a_window_of_others,
       scenario=too_fast(0, 3000, start={"c.offset": -4}))  # fmt: skip
def lowered_in_every_window(s: Seen) -> Bit:
    """Every channel's limit is lowered while a window is open, that of the first to brake too."""
    return all_of(*(s[n].lowered == s.common.sync.window.open for n in CHANNELS))


@claim(Ts7, symbolic=["wheel"], expect=PROVED, requirement="TS7-5", source="one switch [P]; right as delivered [A]",
       witness=Scenario(3, {"speed": 164 * SCALE - 1}))  # fmt: skip
def axle_turns_by_the_switch_as_delivered(s: Seen) -> Bit:
    """As delivered the wheel has the diameter that the switch shows: a pulse comes just where its period is full."""
    return s.axle.pulse == (s.axle.phase + s.speed >= SCALE * s.wheel.int())


@claim(Ts7, symbolic=["wheel"], expect=REFUTED, requirement="TS7-5", twin_of=axle_turns_by_the_switch_as_delivered,
       scenario=Scenario(3, {"speed": 160 * SCALE}))  # fmt: skip
def axle_turns_by_the_smallest_wheel(s: Seen) -> Bit:
    """As delivered the wheel has 780 mm, whatever the switch shows."""
    return s.axle.pulse == (s.axle.phase + s.speed >= SCALE * 156)
