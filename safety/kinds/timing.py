"""Kinds that show the right value at the wrong time."""

from __future__ import annotations

from dataclasses import replace
from typing import cast

from safety.kinds.kind import POINT, Kind, Part, Seat, choose, resting, whole
from safety.system import ANY, ModelError
from safety.terms import Bit, UInt, select
from safety.terms.graph import Term, uint


def frozen() -> Kind:
    """Frozen: the value seen at the last healthy step stays."""

    def effect(seat: Seat, healthy: Term) -> Term:
        last = seat.register("last", healthy.sort, ANY)
        seat.then(last, choose(seat.active, last, healthy))
        return last

    return Kind("frozen", "keeps the last healthy value (at power-up: any value)", effect)


def delayed(ticks: int) -> Kind:
    """Delayed: the value of `ticks` steps ago is seen; before there is one, 0 (or the least value)."""
    whole(ticks, 1, f"delayed({ticks!r})", "a delay is 1 step or more")

    def effect(seat: Seat, healthy: Term) -> Term:
        value = healthy
        for k in range(ticks):
            stage = seat.register(f"stage{k}", healthy.sort, resting(healthy.sort))
            seat.then(stage, value)
            value = stage
        return value

    return Kind(f"delayed by {ticks}", f"shows the value of {ticks} steps before (at first: 0)", effect, unit="steps")


def slow_to_operate(steps: int) -> Kind:
    """Relay slow to operate: the contact closes `steps` steps late and opens in time; shorter closings are lost.

    Before power-up it was open; so it was for `slow_to_release`.
    """
    whole(steps, 1, f"slow_to_operate({steps!r})", "a contact closes 1 step late or more")

    def effect(seat: Seat, healthy: Term) -> Term:
        closed = cast(Bit, healthy)
        return closed & (_since(seat, closed, steps, 0) >= steps)

    meaning = f"the contact closes {steps} step(s) late and opens in time"
    return Kind(f"{steps} step(s) slow to operate", meaning, effect, ("bit",), unit="steps")


def slow_to_release(steps: int) -> Kind:
    """Relay slow to release: the contact opens `steps` steps late and closes in time; shorter openings are lost."""
    whole(steps, 1, f"slow_to_release({steps!r})", "a contact opens 1 step late or more")

    def effect(seat: Seat, healthy: Term) -> Term:
        opened = ~cast(Bit, healthy)
        return ~(opened & (_since(seat, opened, steps, steps) >= steps))

    meaning = f"the contact opens {steps} step(s) late and closes in time"
    return Kind(f"{steps} step(s) slow to release", meaning, effect, ("bit",), unit="steps")


def _since(seat: Seat, condition: Bit, most: int, before: int) -> UInt:
    """How many steps the condition has held without a break before this one, at most `most`; at power-up `before`."""
    held = cast(UInt, seat.register("held", uint(most.bit_length()), before))
    seat.then(held, select(condition, select(held < most, (held + 1).low(held.width), held), 0))
    return held


def intermittent(kind: Kind, acts: int, of: int) -> Kind:
    """Intermittent with a duty: the kind acts in the first `acts` of every `of` steps, counted from each onset.

    Onset INTERMITTENT is the other form: acting at any steps whatever, which a proof leaves open.
    """
    if not isinstance(kind, Kind):
        raise ModelError(f"intermittent({kind!r}, ...): the first argument is the kind, e.g. stuck(0)")
    whole(acts, 1, f"intermittent(..., {acts!r}, {of!r})", "it acts for 1 step or more")
    if type(of) is not int or of <= acts:
        raise ModelError(f"intermittent(..., {acts}, {of!r}): it acts in {acts} of more than {acts} steps")

    def gate(seat: Seat) -> Bit:
        around = sum(s.path.startswith(f"{seat.name}.duty") for s in seat.states)  # duties that this one is within
        label = f"duty{of}.{around}" if around else f"duty{of}"
        turn = cast(UInt, seat.register(label, uint((of - 1).bit_length()), 0))
        seat.then(turn, select(seat.active, select(turn == of - 1, 0, (turn + 1).low(turn.width)), 0))
        return turn < acts

    def effect(seat: Seat, healthy: Term) -> Term:
        now = gate(seat)
        return choose(now, kind.effect(seat.only_while(now), healthy), healthy)

    def joint(seat: Seat, healthy: tuple[Term, ...]) -> tuple[Term, ...]:
        now = gate(seat)
        assert kind.joint is not None
        seen = kind.joint(seat.only_while(now), healthy)
        return tuple(choose(now, s, h) for s, h in zip(seen, healthy, strict=True))

    def update(seat: Seat, part: Part) -> tuple[Term, ...]:
        now = gate(seat)
        assert kind.update is not None
        following = kind.update(seat.only_while(now), part)
        return tuple(choose(now, f, s.next) for f, s in zip(following, part.states, strict=True))

    return replace(
        kind,
        name=f"{kind} in {acts} of {of} steps",
        meaning=f"{kind.meaning}, in {acts} of every {of} steps",
        effect=effect if kind.place == POINT else kind.effect,
        joint=joint if kind.joint else None,
        update=update if kind.update else None,
        members=tuple((point, intermittent(member, acts, of)) for point, member in kind.members),
        unit="steps",
        reference="",
    )
