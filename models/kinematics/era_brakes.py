"""Decelerations and build-up times of a train in the braking-curve tool of the European Union Agency for Railways.

An independent check of braking from steps of deceleration; speeds km/h where they are looked up, decelerations m/s^2.
Lambda trains are known by brake percentage and length, gamma trains by tables.  A step table holds the value of the
last breakpoint not above the speed.
Source: braking-curve tool, version 3.0, train data and conversion model [P].
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from models.kinematics.refusal import refuse
from safety import ModelError

Inputs = dict[str, Any]
Steps = Sequence[Sequence[float]]
SERVICE_PERCENTAGE_MOST = 135.0
WRONG_NAME_FROM = 180.0  # km/h, from which the tool's service brake reads the emergency percentage
CUBICS = (  # up to km/h: coefficients of the brake percentage
    (100.0, (0.0663, 0.00472, 6.1e-5, -6.3e-7)),
    (120.0, (0.13, 0.00514, -4.54e-6, 2.73e-7)),
    (150.0, (0.0479, 0.00581, -6.76e-6, 5.58e-8)),
    (180.0, (0.048, 0.00552, -3.85e-6, 3.0e-8)),
    (float("inf"), (0.0559, 0.00506, 1.66e-6, 3.23e-9)),
)


class Brakes(NamedTuple):
    """Decelerations by speed, km/h, and the times, s, until they act."""

    emergency: Callable[[float], float]
    service: Callable[[float], float]
    t_be: float
    t_bs: float


def stepped(table: Steps, v: float) -> float:
    """The value of the last breakpoint not above v; ModelError below the first one."""
    found = [value for start, value in table if start <= v]
    if not found:
        refuse("lookup", v, "", "it lies before the table's first breakpoint", f"{table[0][0] if table else 'none'}")
    return found[-1]


def brakes(inputs: Inputs, quirk: bool = False) -> Brakes:
    """The brakes of a train; `quirk` reproduces the tool's wrong name in the service brake from 180 km/h up.

    Raises ModelError for a train that is neither lambda nor gamma, or of another brake position.
    """
    kind = inputs["train"]["type"]
    if kind not in ("Lambda", "Gamma"):
        raise ModelError(f"train type {kind!r}: write Lambda or Gamma")
    return _lambda(inputs, quirk) if kind == "Lambda" else _gamma(inputs)


def _gamma(inputs: Inputs) -> Brakes:
    gamma, wet_allowed = inputs["gamma"], inputs["national"]["M_NVAVADH"]

    def emergency(v: float) -> float:
        wet = stepped(gamma["Kwet_rst_steps"], v)
        dry = stepped(gamma["Kdry_rst_steps"], v)
        found: float = dry * (wet + wet_allowed * (1 - wet)) * stepped(gamma["A_brake_emergency_steps"], v)
        return found

    return Brakes(emergency, lambda v: stepped(gamma["A_brake_service_steps"], v), gamma["T_be_s"], gamma["T_bs_s"])


def _lambda(inputs: Inputs, quirk: bool) -> Brakes:
    train, national = inputs["train"], inputs["national"]
    percentage, length = float(inputs["lambda"]["brake_percentage"]), float(train["length_m"])
    if not 0 < percentage <= 250:
        refuse("brake percentage", percentage, "%", "the conversion model does not reach", "within 30 to 250 %")
    served = min(percentage, SERVICE_PERCENTAGE_MOST)
    corrected = stepped(national["Kr_int"], length)
    t_be, t_bs = build_up(train["brake_position"], length)

    def emergency(v: float) -> float:
        return by_speed(inputs, percentage, v) * corrected * converted(percentage, v)

    def service(v: float) -> float:
        return converted(percentage if quirk and v >= WRONG_NAME_FROM else served, v)

    return Brakes(emergency, service, t_be * national["Kt_int"], t_bs)


def converted(percentage: float, v: float) -> float:
    """Deceleration of a brake percentage: constant up to a speed, then cubic in the percentage."""
    if v < 16.85 * percentage**0.428:
        return 0.0075 * percentage + 0.076
    a0, a1, a2, a3 = next(coefficients for end, coefficients in CUBICS if v < end)
    return a0 + a1 * percentage + a2 * percentage**2 + a3 * percentage**3


def by_speed(inputs: Inputs, percentage: float, v: float) -> float:
    """The national correction by speed: one table for freight, for passengers between two by deceleration."""
    national = inputs["national"]
    if inputs["train"]["brake_position"].startswith("Freight"):
        return stepped(national["Kv_int_freight"], v)
    weak, strong = national["A_NVP12"], national["A_NVP23"]
    share = min(max((0.0075 * percentage + 0.076 - weak) / (strong - weak), 0.0), 1.0)
    a, b = (stepped(national[f"Kv_int_passenger_{table}"], v) for table in "ab")
    found: float = a + share * (b - a)
    return found


def build_up(position: str, length: float) -> tuple[float, float]:
    """Equivalent build-up times, s, of emergency and service brake, to a stop; ModelError beyond the model."""
    q = length / 100
    known = ("Passenger in P", "Freight in P", "Freight in G")
    if position not in known:
        raise ModelError(f"brake position {position!r}: write one of {', '.join(known)}")
    if position == "Passenger in P":
        return 2.3 + 0.17 * max(q, 4.0) ** 2, 3 + 1.5 * q + 0.1 * q * q
    if not 0 < length <= 1500:
        refuse("length of a freight train", length, "m", "the model of its brakes ends there", "1500 m")
    if length > 900:
        return -0.4 + 1.6 * q + 0.03 * q * q, 10.5 + 0.32 * q + 0.18 * q * q
    if position == "Freight in P":
        return 2.3 + 0.17 * max(q, 4.0) ** 2, 3 + 2.77 * q
    return 12 + 0.05 * q * q, 3 + 2.77 * max(q, 4.0)
