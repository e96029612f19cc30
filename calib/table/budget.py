"""What an interval is made of: the variance of a pad friction, split by what is not known.

The page `validation` of the manual says what each part holds. Not counted: the centre of gravity,
areas and radii of the brakes, which are taken as the vehicle file has them.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from calib.car.bias import front_share
from calib.car.vehicle import Vehicle
from calib.table.table import Calibration, Table, Value

Parts = Mapping[str, float]
"""Variance of the logarithm of a pad friction [1] by the name of its cause."""

_ADVICE = {
    "mass": "weigh the car with driver and load, and state it: --mass, or mass and "
    "mass_tolerance = 0.005 in the vehicle file",
    "resistance": "add a coast log over a wide range of speeds to the fit",
    "accelerometer": "log v if it is not logged, and zero a_x on level ground",
    "tyres": "log v if it is not logged, and add a ramp with the brakes of one axle only to the "
    "fit, wheel pressures logged",
    "zeros": "start the log earlier: 3 s of straight rolling in front of the braking",
    "load_geometry": "log v if it is not logged, fit with a ramp up to a higher deceleration, and "
    "give the effect pitch_coupling if it is known",
    "unlike_pads": "log v if it is not logged, brake longer and harder, and add a ramp with the "
    "brakes of one axle only to the fit, wheel pressures logged: that tells front from rear pads",
    "cars": "fit a table of this car, or merge more cars",
    "ramp": "fit the table again: this one does not say what its pads rest on",
    "noise": "brake longer, with finer wheel speeds",
}
"""What shrinks each part: an entry in the vehicle file, or a drive."""

PARTS = tuple(_ADVICE)
"""Names of all parts, in the order in which they are printed."""


@dataclass(frozen=True)
class AxleBudget:
    """A pad friction [1] and the variance of its logarithm by part; a part of zero is left out."""

    pad_friction: float
    parts: Parts

    @property
    def sigma(self) -> float:
        """Standard deviation of the logarithm [1]."""
        return math.sqrt(sum(self.parts.values()))

    @property
    def relative(self) -> dict[str, float]:
        """Standard deviation [1] of each part, the largest first: their squares add up."""
        ordered = sorted(self.parts.items(), key=lambda item: -item[1])
        return {part: math.sqrt(variance) for part, variance in ordered}

    @property
    def largest(self) -> str:
        """Name of the largest part."""
        return max(self.parts, key=lambda part: self.parts[part])

    @property
    def words(self) -> str:
        """The three largest parts.

        >>> AxleBudget(0.4, {"tyres": 1e-4, "mass": 9e-4, "load_geometry": 4e-6}).words
        'one sigma of mass 3.0 %, tyres 1.0 %, load geometry 0.2 %'
        """
        named = [(part.replace("_", " "), 100 * x) for part, x in self.relative.items()][:3]
        return "one sigma of " + ", ".join(f"{part} {percent:.1f} %" for part, percent in named)


def advice_lines(axles: Iterable[AxleBudget]) -> list[str]:
    """One line for each part that is the largest of an axle, with what would shrink it."""
    largest = dict.fromkeys(axle.largest for axle in axles)
    return [f"to shrink {part.replace('_', ' ')}: {_ADVICE[part]}" for part in largest]


def summary(front: AxleBudget, rear: AxleBudget) -> dict[str, object]:
    """Both axles for a JSON file: the parts as relative standard deviations [1], and the advice."""
    axles = {"front": front, "rear": rear}
    largest = {name: {"part": x.largest, "do": _ADVICE[x.largest]} for name, x in axles.items()}
    return {**{name: axle.relative for name, axle in axles.items()}, "largest": largest}


def pads_budget(table: Table) -> tuple[AxleBudget, AxleBudget]:
    """Budgets of the front and the rear pads of the ramps.

    Of a table without a budget only the mass is known.
    """
    cal, held = table.calibration, table.budget
    if held is None:
        ratio = {"ramp": cal.pad_log_ratio.sigma**2}
        return axle_budgets(table.vehicle, cal, level_of(table), ratio)
    front, rear = ({part: x**2 for part, x in of.items()} for of in (held.front, held.rear))
    return (
        AxleBudget(cal.pad_friction_f.value, front),
        AxleBudget(cal.pad_friction_r.value, rear),
    )


def axle_budgets(
    vehicle: Vehicle, cal: Calibration, level: Parts, ratio: Parts
) -> tuple[AxleBudget, AxleBudget]:
    """Budgets of front and rear pads from those of level and ratio (variances).

    The ratio of the pads moves each axle by the other one's share of the brake force.
    """
    share = front_share(vehicle, cal.pad_log_ratio.value)

    def budget(pads: Value, lever: float) -> AxleBudget:
        parts = {p: level.get(p, 0.0) + lever**2 * ratio.get(p, 0.0) for p in PARTS}
        return AxleBudget(pads.value, {part: x for part, x in parts.items() if x > 0.0})

    return budget(cal.pad_friction_f, 1.0 - share), budget(cal.pad_friction_r, share)


def level_of(table: Table) -> Parts:
    """Variance of the logarithm of the pad level of the ramps [1] by part."""
    if table.budget is not None:
        return table.budget.level
    cal = table.calibration
    of_ratio = (front_share(table.vehicle, cal.pad_log_ratio.value) - 0.5) * cal.pad_log_ratio.sigma
    total = max((cal.pad_scale.sigma / cal.pad_scale.value) ** 2 - of_ratio**2, 0.0)
    mass = min(table.vehicle.mass_tolerance**2, total)
    return {"mass": mass, "ramp": total - mass}
