"""What an interval is made of: how well a pad friction is known, split by what is not known.

The page `validation` of the manual says what each part holds. Not counted: the centre of gravity,
areas and radii of the brakes, which are taken as the vehicle file has them.
"""

import math
from collections.abc import Iterable, Mapping, Sequence

from calib.base.names import AXLE_NAMES
from calib.base.plain import rows
from calib.car.bias import front_share
from calib.car.vehicle import Vehicle
from calib.table.table import Table, TableBudget

Parts = dict[str, float]
"""Standard deviation of ln of a pad friction [1] by its cause: the squares add up to the whole."""

Variances = Mapping[str, float]
"""The squares, of ln of pad level or ratio too."""

_ADVICE = {row["part"]: row["do"] for row in rows("budget.csv", "calib.table")}
"""What shrinks each part: an entry in the vehicle file, or a drive."""


def deviations(variances: Variances) -> Parts:
    """Standard deviation of each part; one of zero is left out."""
    return {part: math.sqrt(x) for part, x in variances.items() if x > 0.0}


def largest(parts: Parts) -> str:
    """Name of the largest part."""
    return max(parts, key=parts.__getitem__)


def words(parts: Parts) -> str:
    """The three largest parts.

    >>> words({"tyres": 0.01, "mass": 0.03, "load_geometry": 0.002})
    'one sigma of mass 3.0 %, tyres 1.0 %, load geometry 0.2 %'
    """
    ordered = sorted(parts.items(), key=lambda one: -one[1])[:3]
    told = (f"{part.replace('_', ' ')} {100.0 * x:.1f} %" for part, x in ordered)
    return "one sigma of " + ", ".join(told)


def limiting(axles: Sequence[Parts]) -> str:
    """The largest part of each axle, one standard deviation.

    >>> limiting([{"tyres": 0.01, "mass": 0.03}, {"unlike_pads": 0.04}])
    'mass (3.0 % front), unlike pads (4.0 % rear)'
    """
    told: dict[str, list[str]] = {}
    for axle, parts in zip(AXLE_NAMES.values(), axles, strict=True):
        most = largest(parts)
        told.setdefault(most.replace("_", " "), []).append(f"{100.0 * parts[most]:.1f} % {axle}")
    return ", ".join(f"{part} ({', '.join(of)})" for part, of in told.items())


def advice_lines(axles: Iterable[Parts]) -> list[str]:
    """One line for each part that is the largest of an axle, with what would shrink it."""
    most = dict.fromkeys(map(largest, axles))
    return [f"to shrink {part.replace('_', ' ')}: {_ADVICE[part]}" for part in most]


def summary(front: Parts, rear: Parts) -> dict[str, object]:
    """Both axles for a JSON file: their parts, the largest of each, and what shrinks it."""
    axles = {"front": front, "rear": rear}
    most = {axle: largest(parts) for axle, parts in axles.items()}
    return {**axles, "largest": {axle: {"part": p, "do": _ADVICE[p]} for axle, p in most.items()}}


def axle_parts(
    vehicle: Vehicle, log_ratio: float, level: Variances, ratio: Variances
) -> tuple[Parts, Parts]:
    """Parts of front and rear pads by those of their ``level`` and their ``ratio``.

    The ratio of the pads, ``log_ratio`` as of `front_share`, moves each axle by the other one's
    share of the brake force.
    """
    share = front_share(vehicle, log_ratio)
    front, rear = (
        {p: level.get(p, 0.0) + lever**2 * ratio.get(p, 0.0) for p in {**level, **ratio}}
        for lever in (1.0 - share, share)
    )
    return deviations(front), deviations(rear)


def budget_of(table: Table) -> TableBudget:
    """What the pads of a table rest on; where it does not say, only the mass is known."""
    if table.budget is not None:
        return table.budget
    car, scale, ratio = table.vehicle, table.calibration.pad_scale, table.calibration.pad_log_ratio
    of_ratio = (front_share(car, ratio.value) - 0.5) * ratio.sigma
    total = max((scale.sigma / scale.value) ** 2 - of_ratio**2, 0.0)
    mass = min(car.mass_tolerance**2, total)
    level = {"mass": mass, "ramp": total - mass}
    front, rear = axle_parts(car, ratio.value, level, {"ramp": ratio.sigma**2})
    return TableBudget(front, rear, level, {"ramp": table.posterior.covariance})
