"""Wrong common parts: vote, relays, isolation, synchronisation, supply."""

from __future__ import annotations

from models.ts7.channel import Demand
from models.ts7.power import Power
from models.ts7.voting import (
    ChannelRelays,
    CommonPart,
    Output,
    Relay,
    Synchronisation,
    Trio,
    Vote,
    disagree,
    outvoted,
)
from safety import Bit, any_of, at_least, bit, point, select


class TwoOfTwo(CommonPart):
    """After an isolation both remaining channels have to brake."""

    def released(self, runs: Trio, isolated: Trio) -> Bit:
        remaining = (run & ~out for run, out in zip(runs, isolated, strict=True))
        return select(any_of(*isolated), any_of(*remaining), at_least(2, *runs))


class OneOfThree(CommonPart):
    """One relay NBRR that is up releases the brake."""

    def released(self, runs: Trio, isolated: Trio) -> Bit:
        return any_of(*runs)


class Inverted(CommonPart):
    """The output is inverted: NB is released while two channels brake."""

    def released(self, runs: Trio, isolated: Trio) -> Bit:
        return ~super().released(runs, isolated)


class DualFaultRuns(CommonPart):
    """Two isolated channels do not bring the emergency brake."""

    def permitted(self, isolated: Trio, rolling_back: Trio) -> Bit:
        return ~any_of(*rolling_back)


class WithoutRevC(CommonPart):
    """The contact of channel c is missing in the roll-back chain."""

    def permitted(self, isolated: Trio, rolling_back: Trio) -> Bit:
        return super().permitted(isolated, rolling_back._replace(c=bit(False)))


class EnergisedToBrake(Relay):
    """The relay is energised to brake, not to release."""

    def step(self, energised: Bit) -> tuple[EnergisedToBrake, Bit]:
        following, contact = super().step(~energised)
        return following, contact


class ChannelUpWithoutSupply(ChannelRelays):
    """The relays of a channel stay up when its supply is lost."""

    def step(self, drive: Bit, cut: Bit, supply: Bit) -> tuple[ChannelUpWithoutSupply, Vote]:
        point("supply", supply)  # a place for faults, though nothing is fed
        chr_relay, in_service = self.chr_relay.step(~cut)
        nbrr_relay, runs = self.nbrr_relay.step(in_service & drive)
        return type(self)(chr_relay=chr_relay, nbrr_relay=nbrr_relay), Vote(chr=in_service, nbrr=runs)


class IsolatedRuns(ChannelRelays):
    """The relay NBRR of an isolated channel follows its drive: it votes to run."""

    def step(self, drive: Bit, cut: Bit, supply: Bit) -> tuple[IsolatedRuns, Vote]:
        fed = point("supply", supply)
        chr_relay, in_service = self.chr_relay.step(fed & ~cut)
        nbrr_relay, runs = self.nbrr_relay.step(fed & drive)
        return type(self)(chr_relay=chr_relay, nbrr_relay=nbrr_relay), Vote(chr=in_service, nbrr=runs)


class UpWithoutSupply(CommonPart):
    """No relay of the common part depends on the supply."""

    def step(self, a: Demand, b: Demand, c: Demand, supply: Bit) -> tuple[UpWithoutSupply, Output]:
        following, output = super().step(a, b, c, bit(True))
        return following, output


class SupplyFromNowhere(Power):
    """After the change-over there is supply, whether or not the motor-generator delivers."""

    def step(self, inverter: Bit, mg: Bit) -> tuple[SupplyFromNowhere, Bit]:
        following, supply = super().step(inverter, mg | self.standby)
        return following, supply


class IgnoresReports(Synchronisation):
    """A channel that reports its own fault stays in service."""

    def step(self, brakes: Trio, starts: Bit, faults: Trio, out_of_service: Bit) -> tuple[IgnoresReports, Trio]:
        following, cut = super().step(brakes, starts, Trio(bit(False), bit(False), bit(False)), out_of_service)
        return following, cut


class IsolatesTheMajority(Synchronisation):
    """At the end of a window the two channels that agree are isolated, not the one that stands alone."""

    def odd(self, seen: Trio) -> Trio:
        alone = outvoted(seen)
        return Trio(*(any_of(*alone) & ~one for one in alone))


class LowersAll(Synchronisation):
    """In a window all limits are lowered, also that of the channel that braked first."""

    def lowered(self) -> Trio:
        return Trio(*(self.window.open for _ in range(3)))


class OnlyWhenOneStarts(Synchronisation):
    """A window opens only at the instant at which a channel starts to brake."""

    def opens(self, brakes: Trio, starts: Bit) -> Bit:
        return starts & disagree(brakes)


class GoesOnAfterIsolation(Synchronisation):
    """Synchronisation goes on after an isolation."""

    def over(self, cut: Trio, out_of_service: Bit) -> Bit:
        return bit(False)
