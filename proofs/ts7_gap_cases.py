"""TS-7 synchronisation: the cases that the text leaves open, decided by the reference rule in the common part.

One step is one frame, 125 us; the channels may do anything, their demands are free inputs; T_sync is 2400
to 8000 frames.  "Brakes" means: brakes at any instant of the window, as voted.

Main results: in each of the cases the verdict at the end of a window falls on the channel that stands alone and on no
other: the first if neither other follows, the silent one if exactly one follows or if two braked at once, nobody if all
did.  Afterwards either of the two that remain brakes the train alone, within 161 frames.
Source: first two cases [P]; exactly one follows, two at once [R]; brakes at any instant, T_sync, relay times [A].
"""

from __future__ import annotations

from collections.abc import Callable

from models.ts7.voting import CommonPart
from proofs.ts7_brake_chain import CHANNELS, RELEASE
from proofs.ts7_formulas import Formula, named
from proofs.ts7_synchronisation import EVER, T_SYNC, demands, newly_cut, no_fault_found, three
from safety import PROVED, REFUTED, Bit, Scenario, Seen, age, all_of, any_of, at_least, claim, count, implies, persists


def verdict_is_due(s: Seen) -> Bit:
    """The last frame of a window, all channels being in service."""
    window = s.sync.window
    return window.open & (window.age + 1 >= s.sync.frames) & ~any_of(*three(s.sync, "cut_"), *three(s, "isolated."))


def has_braked(s: Seen, n: str) -> Bit:
    """Channel n has braked at some instant of the window, this one included."""
    return s.sync.window[f"seen_{n}"] | s.brakes[n]


def braked_are(s: Seen, number: int) -> Bit:
    """A verdict is due, and so many have braked in the window."""
    return verdict_is_due(s) & (count(*(has_braked(s, n) for n in CHANNELS)) == number)


def just(s: Seen, alone: Callable[[Seen, str], Bit]) -> Bit:
    """Those channels are isolated now of which `alone` is true, and no others."""
    return all_of(*(~(newly_cut(s, n) ^ alone(s, n)) for n in CHANNELS))


def silent(s: Seen, n: str) -> Bit:
    """Channel n has not braked in the window."""
    return ~has_braked(s, n)


def case(run: Scenario, source: str, fails: Formula | None = None) -> Callable[[Formula], Formula]:
    """Declare one case; with `fails`, the twin of that claim, which the run refutes."""
    if fails:
        return claim(CommonPart, given=no_fault_found, symbolic=T_SYNC, expect=REFUTED, requirement="TS7-10",
                     twin_of=fails, scenario=run, source=source)  # fmt: skip
    return claim(CommonPart, given=no_fault_found, symbolic=T_SYNC, expect=PROVED, requirement="TS7-10", witness=run,
                 source=source)  # fmt: skip


A_ALONE = demands(5500, a=[(1000, EVER)], b=[], c=[])
B_FOLLOWS = demands(5500, a=[(1000, EVER)], b=[(1300, EVER)], c=[])
TWO_AT_ONCE = demands(5500, a=[(1000, EVER)], b=[(1000, EVER)], c=[])
ALL_FOLLOW = demands(5500, a=[(1000, EVER)], b=[(1300, EVER)], c=[(1500, EVER)])


@case(A_ALONE, "[P] 1.6")
def neither_follows_the_first_is_isolated(s: Seen) -> Bit:
    """Neither other follows: the first is isolated, nobody else."""
    return implies(braked_are(s, 1), just(s, has_braked))


@case(A_ALONE, "[P] 1.6", fails=neither_follows_the_first_is_isolated)
def neither_follows_the_first_stays_in_service(s: Seen) -> Bit:
    """Neither other follows: the first stays in service.  False: it is isolated."""
    return implies(braked_are(s, 1), ~newly_cut(s, "a"))


@case(B_FOLLOWS, "[R] 1.6")
def one_follows_the_silent_one_is_isolated(s: Seen) -> Bit:
    """Two have braked in the window, one after the other or at once: the silent third is isolated, nobody else."""
    return implies(braked_are(s, 2), just(s, silent))


@case(B_FOLLOWS, "[R] 1.6", fails=one_follows_the_silent_one_is_isolated)
def one_follows_nobody_is_isolated(s: Seen) -> Bit:
    """Exactly one follows: nobody is isolated.  False: the silent one is."""
    return implies(braked_are(s, 2), ~any_of(*(newly_cut(s, n) for n in CHANNELS)))


@case(TWO_AT_ONCE, "[R] 1.6", fails=one_follows_the_silent_one_is_isolated)
def of_two_at_once_one_is_isolated(s: Seen) -> Bit:
    """Two brake at once, the third is silent: one of the two is isolated.  False: the third is."""
    return implies(braked_are(s, 2) & silent(s, "c"), newly_cut(s, "a") | newly_cut(s, "b"))


@case(ALL_FOLLOW, "[P] 1.6")
def all_follow_nobody_is_isolated(s: Seen) -> Bit:
    """All have braked in the window: nobody is isolated."""
    return implies(braked_are(s, 3), just(s, silent))


@case(ALL_FOLLOW, "[P] 1.6", fails=all_follow_nobody_is_isolated)
def all_follow_the_last_is_isolated(s: Seen) -> Bit:
    """All have braked in the window: the last to brake is isolated.  False: nobody is."""
    return implies(braked_are(s, 3), newly_cut(s, "c"))


# --- and the brake -------------------------------------------------------------------------------------------------


def two_brake(s: Seen) -> Bit:
    """Two channels brake at least, as voted."""
    return at_least(2, *(s.brakes[n] for n in CHANNELS))


def relay_is_timed(condition: Formula) -> Formula:
    """Lemma: while the condition holds and NB is up, its release time runs."""

    def lemma(s: Seen) -> Bit:
        relay = s.nb_relay
        return ~relay.closed | ((age(condition(s), RELEASE + 1) <= relay.waited) & (relay.waited <= RELEASE))

    return named(f"NB falls while {condition.__name__}", lemma)


@claim(CommonPart, symbolic=T_SYNC, expect=PROVED, requirement="TS7-7", source="[P] two out of three; relay times [A]",
       lemmas=[relay_is_timed(two_brake)], witness=B_FOLLOWS)  # fmt: skip
def two_of_three_brake_the_train(s: Seen) -> Bit:
    """While two channels brake for 161 frames, the train is braked, whoever is isolated: an isolated one brakes too."""
    return implies(persists(two_brake(s), RELEASE + 1), s.nb)


@claim(
    CommonPart,
    symbolic=T_SYNC,
    expect=REFUTED,
    requirement="TS7-7",
    scenario=B_FOLLOWS,
    twin_of=two_of_three_brake_the_train,
)
def two_of_three_brake_the_train_a_frame_earlier(s: Seen) -> Bit:
    """While two channels brake for 160 frames, the train is braked."""
    return implies(persists(two_brake(s), RELEASE), s.nb)


def one_is_out(s: Seen) -> Bit:
    """One channel is out of service, and for so long that its own relay NBRR is down; another one brakes."""
    out = any_of(*(s.isolated[n] & s.brakes[m] for n in CHANNELS for m in CHANNELS if m != n))
    return out & all_of(*(implies(s.isolated[n], s.brakes[n]) for n in CHANNELS))


@claim(CommonPart, symbolic=T_SYNC, expect=PROVED, requirement="TS7-7", source="rule (a) [A]",
       lemmas=[relay_is_timed(one_is_out)], witness=B_FOLLOWS)  # fmt: skip
def either_remaining_channel_brakes_the_train(s: Seen) -> Bit:
    """One channel isolated, its NBRR down: either of the other two brakes the train alone, within 161 frames."""
    return implies(persists(one_is_out(s), RELEASE + 1), s.nb)


@claim(CommonPart, symbolic=T_SYNC, expect=REFUTED, requirement="TS7-7", scenario=A_ALONE,
       twin_of=either_remaining_channel_brakes_the_train)  # fmt: skip
def an_isolated_channel_brakes_the_train(s: Seen) -> Bit:
    """One channel isolated, its NBRR down, for 161 frames: the train is braked.  False: it is one vote."""
    return implies(persists(any_of(*(s.isolated[n] & s.brakes[n] for n in CHANNELS)), RELEASE + 1), s.nb)
