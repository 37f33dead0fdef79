"""Braking curves of the tool of the European Union Agency for Railways, from the inputs of a scenario.

Emergency and service deceleration curves on a grid of 0.1 km/h with the deceleration of the lower end of each step, and
what follows from them: intervention, warning, permitted speed, indication.  A curve is a list of distances before the
target, m, one for each tenth of a km/h, None where it does not exist.
Source: braking-curve tool, version 3.0 [P]; the inputs of its scenarios are read in place.
"""

from __future__ import annotations

from collections.abc import Callable
from math import floor
from typing import NamedTuple

from models.kinematics.era_brakes import Brakes, Inputs, brakes, stepped
from models.kinematics.refusal import positive
from safety import ModelError

Curve = list[float | None]
BEYOND = 30  # km/h above the line speed, to which the grid reaches


class Times(NamedTuple):
    """s: service brake credited, traction cut-off and rest of the build-up, indication."""

    service: float
    emergency: float
    indication: float


class Curves(NamedTuple):
    """Distances in m by tenths of a km/h."""

    ebd: Curve
    sbd: Curve
    ebi: Curve
    sbi1: Curve
    sbi2: Curve
    floi: Curve
    warning: Curve
    permitted: Curve
    indication: Curve


def curves(inputs: Inputs, quirk: bool = False) -> Curves:
    """All curves of a scenario; ModelError for what the rules here do not cover, or for an input that is missing."""
    try:
        return _curves(inputs, brakes(inputs, quirk))
    except (KeyError, TypeError, ValueError) as error:
        raise ModelError(f"scenario: {error!r}; give the inputs as the braking-curve tool has them") from None


def _curves(inputs: Inputs, has: Brakes) -> Curves:
    covered(inputs)
    fixed, line = inputs["fixed"], inputs["track"]["line_speed_kmh"]
    slope = gradients(inputs)
    end, most = round((line + BEYOND) * 10), round(line * 10)
    ebd = integrated(has.emergency, slope, -float(inputs["track"]["distance_EOA_to_SvL_m"]), end)
    sbd = integrated(has.service, slope, 0.0, end)
    t = times(inputs, has)
    top = {name: floor(round((line + excess(fixed, name, line)) * 10, 6)) for name in ("ebi", "sbi", "warning")}
    ebi = later(ebd, t.emergency, top["ebi"])
    sbi1, sbi2 = later(sbd, t.service, top["sbi"]), later(ebi, t.service, top["sbi"])
    floi = [None if a is None or b is None else max(a, b) for a, b in zip(sbi1, sbi2, strict=True)]
    warning = later(floi, fixed["T_warning_s"], top["warning"])
    permitted = later(floi, fixed["T_driver_s"], most)
    indication = later(permitted, t.indication, most)
    raw = Curves(ebd, sbd, ebi, sbi1, sbi2, floi, warning, permitted, indication)
    return clipped(raw, inputs, top)


def covered(inputs: Inputs) -> None:
    """Refuse what these rules say nothing about."""
    train, track = inputs["train"], inputs["track"]
    positive("line speed", track["line_speed_kmh"], "km/h")
    wanted = {
        "target speed": (track["target_speed_kmh"], 0), "reduced adhesion": (track["reduced_adhesion_active"], False),
        "brake inhibition": (track["brake_inhibition_active"], False),
        "speed inaccuracy": (train["speed_inaccuracy_percent"], 0),
        "position inaccuracy": (train["position_inaccuracy_m"], 0),
        "position inaccuracy in %": (train["position_inaccuracy_percent"], 0),
    }  # fmt: skip
    for name, (value, only) in wanted.items():
        if value != only:
            raise ModelError(f"{name} = {value}: not covered by these curves; the nearest admissible value is {only}")


def gradients(inputs: Inputs) -> Callable[[float], float]:
    """The deceleration by gradient, m/s^2, at a distance before the target: the worst under the train's length."""
    track, length = inputs["track"], int(inputs["train"]["length_m"])
    origin, profile, mass = (
        int(track["distance_origin_to_target_m"]),
        track["gradient_profile_m_permille"],
        inputs["train"],
    )
    known, fixed = mass["nominal_rotating_mass_percent"], inputs["fixed"]
    at = [stepped(profile, d) for d in range(origin + 1)]
    worst = [min(at[max(0, d - length) : d + 1]) for d in range(origin + 1)]

    def slope(s: float) -> float:
        g = worst[min(max(round(origin - s), 0), origin)]
        m = fixed["M_rotating_max_percent"] if g > 0 else fixed["M_rotating_min_percent"]
        return float(fixed["g_ms2"] * g / (1000 + 10 * (m if known is None else known)))

    return slope


def integrated(brake: Callable[[float], float], slope: Callable[[float], float], start: float, end: int) -> Curve:
    """The curve upward from a standstill; ModelError where the brake does not hold the train."""
    curve: Curve = [start]
    s = start
    for k in range(end):
        a = brake(k / 10) + slope(s)
        positive(f"deceleration at {k / 10} km/h", a, "m/s^2")
        s += (((k + 1) / 36) ** 2 - (k / 36) ** 2) / (2 * a)
        curve.append(s)
    return curve


def times(inputs: Inputs, has: Brakes) -> Times:
    """The times that stand between a deceleration curve and its intervention."""
    train, cut = inputs["train"], float(inputs["train"]["T_traction_cut_off_s"])
    credited = train["service_brake_interface"] and inputs["national"]["Q_NVSBTSMPERM"]
    service = has.t_bs if credited else 0.0
    if train["traction_cut_off_interface"]:
        cut = max(cut - (inputs["fixed"]["T_warning_s"] + service), 0.0)
    return Times(service, cut + max(has.t_be - cut, 0.0), max(0.8 * has.t_bs, 5.0))


def later(curve: Curve, time: float, top: int) -> Curve:
    """A curve a time earlier in running: V t farther from the target, up to a row."""
    return [None if s is None or k > top else s + k / 36 * time for k, s in enumerate(curve)]


def excess(fixed: Inputs, name: str, line: float) -> float:
    """dV of a curve at the line speed, km/h: least up to one speed, then rising linearly to the most."""
    least, most = fixed[f"dV_{name}_min_kmh"], fixed[f"dV_{name}_max_kmh"]
    low, high = fixed[f"V_{name}_min_kmh"], fixed[f"V_{name}_max_kmh"]
    return float(least + (most - least) * min(max((line - low) / (high - low), 0.0), 1.0))


def value(curve: Curve, row: int) -> float:
    """A point of a curve; ModelError where the curve does not exist."""
    found = curve[row]
    if found is None:
        raise ModelError(f"a curve does not reach {row / 10} km/h; give a line speed that it reaches")
    return found


def clipped(raw: Curves, inputs: Inputs, top: dict[str, int]) -> Curves:
    """Vertical parts at the line speed and at the release speed, and what lies below it emptied."""
    line = inputs["track"]["line_speed_kmh"]
    most, release = round(line * 10), round(min(inputs["track"]["release_speed_fixed_kmh"], line) * 10)
    begins = value(raw.indication, most)
    ahead = begins + inputs["fixed"]["T_preindication_s"] * line / 3.6
    for row in range(most + 1, top["ebi"] + 1):
        raw.indication[row] = begins
    tops = {"ebi": top["ebi"], "sbi1": top["sbi"], "sbi2": top["sbi"], "floi": top["sbi"], "warning": top["warning"],
            "permitted": most}  # fmt: skip
    for name, row in tops.items():
        getattr(raw, name)[row + 1] = ahead
    start = value(raw.floi, release)
    for curve in (raw.floi, raw.warning, raw.permitted, raw.indication):
        curve[:release] = [None] * release
    for curve in (raw.ebi, raw.sbi1, raw.sbi2):
        first = next(row for row, s in enumerate(curve) if s is not None and s >= start)
        curve[:first] = [None] * first
        if curve is raw.ebi and first >= release:
            curve[release : first + 1] = [start] * (first + 1 - release)
    return raw
