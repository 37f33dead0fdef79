"""TS-7 power part: thyristor inverter, motor-generator as standby, change-over.

One step is one frame, 125 us.
Source: inverter normal, motor-generator standby, automatic change-over on detected inverter failure [P]; gap [A].
"""

from __future__ import annotations

from safety import U10, Bit, Model, parameter, point, power_up, select


class Power(Model, tick_s="125e-6"):
    """Source of the relays' supply; once changed over it stays on the motor-generator [A]."""

    standby: Bit = power_up(False)
    missing: U10 = power_up(0)  # frames without inverter voltage
    gap: U10 = parameter(400, unit="frame", within=(1, 800), source="[A] 50 ms without supply at change-over")

    def step(self, inverter: Bit, mg: Bit) -> tuple[Power, Bit]:
        """Whether there is supply, given which sources deliver voltage."""
        inverter, mg = point("inverter", inverter), point("mg", mg)
        waited = select(inverter, 0, (self.missing + 1).sat(10))
        standby = self.standby | point("change_over", waited >= self.gap)
        supply = select(self.standby, mg, inverter)
        return type(self)(standby=standby, missing=waited), point("supply", supply)
