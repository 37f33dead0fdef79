"""TS-7, the whole equipment of one driving end: axle, signals, three channels, common part, power.

One step is one frame, 125 us; the three channels share it (own oscillators: see the claims in a channel's own frames).
Source: triple speed-check part, one common part, one power part, one wheel-diameter switch for all [P].
"""

from __future__ import annotations

from typing import Annotated

from models.ts7.channel import Channel
from models.ts7.power import Power
from models.ts7.signals import Lines, Selection, WiredOr
from models.ts7.train import Axle, Speed
from models.ts7.voting import BothMustBrake, CommonPart, EdgeCommonPart, Output, SettlingCommonPart
from safety import U8, Bit, Int, Model, parameter, point

WheelError = Annotated[Int, (-4, 4)]


class WheelSwitch(Model):
    """The one wheel-diameter switch of the common part, and the diameter that the wheel really has."""

    wheel: U8 = parameter(164, unit="5 mm", within=(156, 172), source="[P] switch 780..860 mm; 164 is 820 mm")
    wheel_error: WheelError = parameter(
        0, unit="5 mm", within=(-4, 4), source="[A] true minus set diameter; half a step is 1, one step 2"
    )


class Ts7(WheelSwitch, tick_s="125e-6"):
    """ATC equipment TS-7 behind the axle of the train; brake outputs true = brake."""

    axle: Axle
    power: Power
    lines_a: Selection
    lines_b: Selection
    lines_c: Selection
    a: Channel
    b: Channel
    c: Channel
    common: CommonPart

    def step(self, lines: Lines, speed: Speed, backward: Bit, inverter: Bit, mg: Bit) -> tuple[Ts7, Output]:
        """One frame: signal lines, true speed (1/4096 word per frame), direction, voltage of the two sources."""
        axle, seen = self.axle.step(speed, backward, (self.wheel + self.wheel_error).sat(8))
        power, supply = self.power.step(inverter, mg)
        wheel, lowered = point("wheel_switch", self.wheel), self.common.sync.lowered()
        lines_a, word_a = self.lines_a.step(lines)
        lines_b, word_b = self.lines_b.step(lines)
        lines_c, word_c = self.lines_c.step(lines)
        a, demand_a = self.a.step(word_a, wheel, lowered.a, seen.pulse, seen.backward)
        b, demand_b = self.b.step(word_b, wheel, lowered.b, seen.pulse, seen.backward)
        c, demand_c = self.c.step(word_c, wheel, lowered.c, seen.pulse, seen.backward)
        common, output = self.common.step(demand_a, demand_b, demand_c, supply)
        channels = {"lines_a": lines_a, "lines_b": lines_b, "lines_c": lines_c, "a": a, "b": b, "c": c}
        return type(self)(axle=axle, power=power, **channels, common=common), output


class RuleB(Ts7, tick_s="125e-6"):
    """Vote by rule (b), to be refuted."""

    common: BothMustBrake


class EdgeRule(Ts7, tick_s="125e-6"):
    """Synchronisation by the edge rule, to be refuted."""

    common: EdgeCommonPart


class Settling(Ts7, tick_s="125e-6"):
    """Synchronisation whose window ends with the last brake command [A]."""

    common: SettlingCommonPart


class WiredSignals(Ts7, tick_s="125e-6"):
    """Signal lines wire-ORed onto the matrix in every channel: a required hazard."""

    lines_a: WiredOr
    lines_b: WiredOr
    lines_c: WiredOr
