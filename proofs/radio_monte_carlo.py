"""Radio control, sampled: messages that do not come, and a driver who wants another speed every 5 s.

Each mission is drawn with a pinned seed and run on the model; the share of dangerous ones is bounded by Clopper and
Pearson at 99 %.  This is sampling, not proof: the distributions are assumed [A], and what is rare is not seen.  In one
direction of the radio, drawn, nothing is heard for 1 to 25 s, from any moment on; the leader, at 36 km/h, parts after
15 s and leaves its rear; the driver wants 0 to 100 km/h, in one drawn sequence that all missions share.

Result: none of 4000 missions is dangerous, so at most 0.14 % are, with 99 % confidence.
"""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

from models.kinematics import mps
from models.radio.bench import Driven
from proofs.radio_campaign import START, parting, trains
from safety import TRANSIENT, Fault, stuck
from safety.inject import Campaign, Group
from safety.inject.statistics.binomial import clopper_pearson

MISSIONS, SEED, CONFIDENCE = 4000, 1991, 0.99
WHIM = 50  # steps
WANTED = [random.Random(SEED + k).randint(0, 100) for k in range(parting.measured // WHIM + 1)]  # km/h


def silent(pick: random.Random) -> Fault:
    """One direction of the radio hears nothing for a while."""
    channel = pick.choice(("reports", "authorities", "echoes"))
    at, ticks = pick.randint(0, 400), pick.randint(10, 250)
    return Fault(stuck(0), [f"pair.follower.{channel}.heard"], TRANSIENT, at=at, ticks=ticks)


def whims(step: int) -> dict[str, Any]:
    """The leader parts; the follower's driver changes his mind."""
    return trains(20, 150)(step) | {"wants": mps(WANTED[step // WHIM])}


messages = Campaign(
    id="radio_monte_carlo_messages", model=Driven, start=START, stimulus=whims, measured=parting.measured,
    faults=[Group("messages", silent, drawn=MISSIONS)], seed=SEED, confidence=CONFIDENCE, hazard="contact",
    expect={"dangerous_undetected": 0, "no_effect": MISSIONS},
)  # fmt: skip


def bounds() -> tuple[Fraction, Fraction]:
    """Exact confidence limits of the share of dangerous missions."""
    cells = [cell for _, cell in messages.inject().injections()]
    low, high = clopper_pearson(sum(cell.startswith("wrong") for cell in cells), len(cells), CONFIDENCE)
    return Fraction(low), Fraction(high)
