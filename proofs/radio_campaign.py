"""Radio control: the failure modes of radio, ground computer and train integrity, injected one by one on two trains.

One step is a cycle of 0.1 s; the follower starts 300 m behind the leader's rear.  **Running**: both at 36 km/h, no
brake is due.  **Parting**: the follower pulls to 72 km/h, the leader's coupling breaks after 15 s and leaves its rear.
Dangerous: the follower's head is beyond the leader's rear.  Safe side: the brake where none is due.

Results: three modes are wrong-side, the two of the ground computer and the parted train that is reported whole.
Whatever the radio loses, delays, corrupts or replays only brakes; replay is dangerous in the table: without stamps.
Failure rates are INVENTED [A].
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from models.ats.failures import RADIO
from models.radio.bench import Driven
from models.radio.ride import commissioned
from proofs.ats_campaign import groups
from safety import Bit
from safety.inject import Campaign, Wires

START = {f"pair.{name}": value for name, value in commissioned(Fraction(300), Fraction(50)).items()}


def trains(wanted: int, parts_at: int | None = None) -> Callable[[int], dict[str, Any]]:
    """The leader at 10 m/s, the follower pulls to `wanted`; a message each second, half a second late."""

    def row(step: int) -> dict[str, Any]:
        return {"send": step % 10 == 0, "hear": step % 10 == 5, "leads": Fraction(10), "wants": Fraction(wanted),
                "parts": step == parts_at}  # fmt: skip

    return row


def braked(wires: Wires) -> Bit:
    """The brake acts, or the unit misses the radio."""
    return wires["brake"] | wires["radio_lost"]


running = Campaign(
    id="radio_running", model=Driven, start=START, stimulus=trains(10), measured=420, faults=groups(RADIO),
    hazard="contact", safe=braked, expect={"safe": 14, "no_effect": 8},
)  # fmt: skip

parting = Campaign(
    id="radio_parting", model=Driven, start=START, stimulus=trains(20, 150), measured=420, faults=groups(RADIO),
    hazard="contact", expect={"dangerous_undetected": 3, "no_effect": 19},
)  # fmt: skip
