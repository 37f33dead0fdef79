"""TS-7 common part: synchronisation and isolation of the channels, relays, voting, output.

One step is one frame, 125 us.  Every relay is energised in the safe-to-run state (fail-safe direction: de-energised).
A channel's brake command is what the vote sees: its relay NBRR is down.

    channel i ---- AC drive, CHR_i up, supply ----> NBRR_i ----> 2 out of 3 ----> relay NB
    isolation latch i, supply -------------------> CHR_i ------> not two down --> relay EB <-- no roll-back

Source: brake and isolation rules, always-energised relays [P], gaps filled [R]; level rule of the window, T_sync, relay
times, rule (a) [A].  After an isolation there is no further synchronisation [P].  The EB is not held by itself [A].
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from models.ts7.channel import Demand
from safety import U10, Bit, Model, UInt, any_of, at_least, bit, parameter, point, power_up, select

U13 = Annotated[UInt, 13]


class Trio(NamedTuple):
    """One wire of each channel."""

    a: Bit
    b: Bit
    c: Bit


class Relay(Model, tick_s="125e-6"):
    """Relay with one front contact: open at power-up, closes late, opens late."""

    closed: Bit = power_up(False)
    waited: U10 = power_up(0)  # frames for which coil and contact have differed
    operate: U10 = parameter(240, unit="frame", within=(0, 800), source="[A] 30 ms from coil to closed contact")
    release: U10 = parameter(160, unit="frame", within=(0, 800), source="[A] 20 ms from coil to open contact")

    def step(self, energised: Bit) -> tuple[Relay, Bit]:
        """The contact follows the coil after its time."""
        coil = point("coil", energised)
        differs = coil ^ self.closed
        moves = differs & (self.waited >= select(coil, self.operate, self.release))
        waited = select(differs & ~moves, (self.waited + 1).low(10), 0)
        closed = self.closed ^ moves
        return type(self)(closed=closed, waited=waited), point("contact", closed)


class Window(Model, tick_s="125e-6"):
    """The time given to the channels that do not brake yet: its age, who braked first, who has braked since."""

    open: Bit = power_up(False)
    age: U13 = power_up(0)
    first_a: Bit = power_up(False)
    first_b: Bit = power_up(False)
    first_c: Bit = power_up(False)
    seen_a: Bit = power_up(False)
    seen_b: Bit = power_up(False)
    seen_c: Bit = power_up(False)

    def step(self, brakes: Trio, opens: Bit, stays: Bit) -> Window:
        """One frame: who brakes at the opening is first, who brakes at any instant is seen."""
        first = Trio(*(select(opens, b, f & stays) for b, f in zip(brakes, self.first(), strict=True)))
        seen = Trio(*(select(opens, b, s & stays) for b, s in zip(brakes, self.seen(brakes), strict=True)))
        return type(self)(
            open=opens | stays, age=select(stays, (self.age + 1).low(13), 0),
            first_a=first.a, first_b=first.b, first_c=first.c, seen_a=seen.a, seen_b=seen.b, seen_c=seen.c,
        )  # fmt: skip

    def first(self) -> Trio:
        """Channels that braked when the window opened."""
        return Trio(self.first_a, self.first_b, self.first_c)

    def seen(self, brakes: Trio) -> Trio:
        """Channels that have braked at any instant of the window, now included."""
        return Trio(self.seen_a | brakes.a, self.seen_b | brakes.b, self.seen_c | brakes.c)


class Rules:
    """The rules of synchronisation that the variants change."""

    def opens(self, brakes: Trio, starts: Bit) -> Bit:
        """Level rule: a window opens whenever one or two channels brake and another does not."""
        return disagree(brakes)

    def settled(self, brakes: Trio) -> Bit:
        """Whether the window ends early, without a verdict: never."""
        return bit(False)

    def over(self, cut: Trio, out_of_service: Bit) -> Bit:
        """After an isolation there is no further synchronisation."""
        return out_of_service | any_of(*cut)

    def odd(self, seen: Trio) -> Trio:
        """Who is isolated at the end of a window: the channel that stands alone."""
        return outvoted(seen)


class Synchronisation(Rules, Model, tick_s="125e-6"):
    """Brake synchronisation: when the channels disagree, the others are lowered and given a time to follow.

    At the end of the window a channel that stands alone, braking or silent, is isolated for good; a channel whose own
    check found it faulty is isolated at once.  Brakes means: brakes at any instant of the window.
    """

    window: Window
    cut_a: Bit = power_up(False)
    cut_b: Bit = power_up(False)
    cut_c: Bit = power_up(False)
    frames: U13 = parameter(4000, unit="frame", within=(2400, 8000), source="[A] T_sync 0.5 s; 0.3 s at least")

    def step(self, brakes: Trio, starts: Bit, faults: Trio, out_of_service: Bit) -> tuple[Synchronisation, Trio]:
        """One frame: brake commands, whether one starts now, faults that channels found, any CHR down."""
        found = Trio(*(cut | fault for cut, fault in zip(self.cut(), faults, strict=True)))
        goes_on = self.window.open & ~self.over(found, out_of_service) & ~self.settled(brakes)
        opens = self.opens(brakes, starts) & ~self.window.open & ~self.over(found, out_of_service)
        last = self.window.age + 1 >= self.frames
        odd = self.odd(self.window.seen(brakes))
        verdict = (point(f"isolate_{n}", goes_on & last & alone) for n, alone in zip("abc", odd, strict=True))
        cut = Trio(*(f | v for f, v in zip(found, verdict, strict=True)))
        window = self.window.step(brakes, opens, goes_on & ~last)
        return type(self)(window=window, cut_a=cut.a, cut_b=cut.b, cut_c=cut.c), cut

    def cut(self) -> Trio:
        """Isolated channels: the latches behind the targets."""
        return Trio(self.cut_a, self.cut_b, self.cut_c)

    def lowered(self) -> Trio:
        """Channels whose limit is lowered now: in a window, all but the first."""
        return Trio(*(self.window.open & ~first for first in self.window.first()))


class EdgeSynchronisation(Synchronisation, tick_s="125e-6"):
    """The variant to be refuted: a channel that falls silent while all three brake is never noticed."""

    def opens(self, brakes: Trio, starts: Bit) -> Bit:
        """Edge rule: only at the instant at which a channel starts to brake."""
        return starts & disagree(brakes)


class SettlingSynchronisation(Synchronisation, tick_s="125e-6"):
    """A variant [A] that tells a release from a failure: when the last brake command ends, so does the window.

    In the reference the channel that releases first, if only by one frame, is isolated as silent.
    """

    def settled(self, brakes: Trio) -> Bit:
        """No channel brakes any more."""
        return ~any_of(*brakes)


def disagree(brakes: Trio) -> Bit:
    """One or two channels brake and another does not."""
    return any_of(*brakes) & ~(brakes.a & brakes.b & brakes.c)


def outvoted(commands: Trio) -> Trio:
    """Each channel against the majority of the three commands."""
    majority = at_least(2, *commands)
    return Trio(*(command ^ majority for command in commands))


class Vote(NamedTuple):
    """Contacts of a channel's two relays in the common part."""

    chr: Bit  # up: in service
    nbrr: Bit  # up: no brake


class ChannelRelays(Model, tick_s="125e-6"):
    """A channel's relays: CHR falls with the isolation latch, NBRR with the AC drive, with CHR and with the supply."""

    chr_relay: Relay
    nbrr_relay: Relay

    def step(self, drive: Bit, cut: Bit, supply: Bit) -> tuple[ChannelRelays, Vote]:
        """Rule (a): an isolated channel's NBRR is down, it counts as a brake vote."""
        fed = point("supply", supply)
        chr_relay, in_service = self.chr_relay.step(fed & ~cut)
        nbrr_relay, runs = self.nbrr_relay.step(fed & in_service & drive)
        return type(self)(chr_relay=chr_relay, nbrr_relay=nbrr_relay), Vote(chr=in_service, nbrr=runs)


class Output(NamedTuple):
    """What the vehicle controller and the driver see."""

    nb: Bit  # normal brake
    eb: Bit  # emergency brake
    brakes: Trio  # brake commands as voted: NBRR down
    isolated: Trio  # CHR down
    targets: Trio  # dropped flags: isolation latched
    synchronising: Bit


class Votes:
    """The two votes of the common part."""

    def released(self, runs: Trio, isolated: Trio) -> Bit:
        """Rule (a): NB is released while two of the three relays NBRR are up."""
        return at_least(2, *runs)

    def permitted(self, isolated: Trio, rolling_back: Trio) -> Bit:
        """No EB: not two channels isolated, and none finds the train rolling back."""
        return ~at_least(2, *isolated) & ~any_of(*rolling_back)


class CommonPart(Votes, Model, tick_s="125e-6"):
    """Relays, synchronisation, 2-out-of-3 vote and output of the common part."""

    a: ChannelRelays
    b: ChannelRelays
    c: ChannelRelays
    sync: Synchronisation
    nb_relay: Relay
    eb_relay: Relay

    def step(self, a: Demand, b: Demand, c: Demand, supply: Bit) -> tuple[CommonPart, Output]:
        """One frame: the three channels' demands and the relay supply."""
        cut = self.sync.cut()
        relays_a, va = self.a.step(a.drive, cut.a, supply)
        relays_b, vb = self.b.step(b.drive, cut.b, supply)
        relays_c, vc = self.c.step(c.drive, cut.c, supply)
        runs, isolated = Trio(va.nbrr, vb.nbrr, vc.nbrr), Trio(~va.chr, ~vb.chr, ~vc.chr)
        brakes = Trio(~runs.a, ~runs.b, ~runs.c)
        was = Trio(self.a.nbrr_relay.closed, self.b.nbrr_relay.closed, self.c.nbrr_relay.closed)
        starts = any_of(*(before & now for before, now in zip(was, brakes, strict=True)))
        sync, targets = self.sync.step(brakes, starts, Trio(a.fault, b.fault, c.fault), any_of(*isolated))
        nb_relay, released = self.nb_relay.step(supply & self.released(runs, isolated))
        eb_relay, permitted = self.eb_relay.step(supply & self.permitted(isolated, Trio(a.rev, b.rev, c.rev)))
        following = type(self)(a=relays_a, b=relays_b, c=relays_c, sync=sync, nb_relay=nb_relay, eb_relay=eb_relay)
        return following, Output(~released, ~permitted, brakes, isolated, targets, self.sync.window.open)


class BothMustBrake(CommonPart, tick_s="125e-6"):
    """Rule (b), to be refuted: an isolated channel has no vote, and both remaining ones must brake."""

    def released(self, runs: Trio, isolated: Trio) -> Bit:
        """Two of three up, or after an isolation one of the remaining ones."""
        remaining = any_of(*(run & ~out for run, out in zip(runs, isolated, strict=True)))
        return select(any_of(*isolated), remaining, at_least(2, *runs))


class EdgeCommonPart(CommonPart, tick_s="125e-6"):
    """The common part with the edge rule."""

    sync: EdgeSynchronisation


class SettlingCommonPart(CommonPart, tick_s="125e-6"):
    """The common part with windows that end with the last brake command."""

    sync: SettlingSynchronisation
