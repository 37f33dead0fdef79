"""TS-7, said exactly: what the parts do in one step, so that nothing else can stand in their text unnoticed.

The claims of the other files say what must not happen.  Where a change of the model leaves them all true, the claim
that tells it apart stands here, written another way than the model.
Source: isolation of the channel that stands alone [P], rule (a) [A].
"""

from __future__ import annotations

from models.ts7.threshold import Thresholds
from proofs.ts7_thresholds import LIMITS
from safety import PROVED, REFUTED, Bit, Seen, all_of, claim, count, implies, previous


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
