"""The uncertainty of a pad friction by part, and what reduces it.

The page `validation` of the manual explains each part. Errors of the areas and radii of the brakes
are not counted.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from calib.base.intervals import Z95
from calib.base.names import AXLE_NAMES
from calib.base.plain import NBSP, plus_minus, rows
from calib.car.balance import front_share
from calib.car.beliefs import CAR
from calib.car.vehicle import Vehicle
from calib.table.table import Calibration, Table

Parts = dict[str, float]
"""Standard deviation of ln of a pad friction [1] by part: the squares add up to the whole."""

_Variances = Mapping[str, float]
"""Variance of ln of a pad friction, of the pads' level or of their ratio [1], by part."""

PER_RUN = ("noise", "zeros")
"""Parts that differ from run to run of the same car.

The others are common to the cars of a line: mass, geometry, road, kind of sensor, method. Their
differences, such as the weight of a driver, are in the scatter between cars.
"""

RAMP, STOP = "ramp", "stop"
"""Kinds of a budget: of a fit, or of a stop. In a stop ``tyres`` is what the ramp left open."""


@dataclass(frozen=True)
class _Advice:
    """What to ``do``, and the share of each part that then remains in a ``budget``, "" for both."""

    do: str
    budget: str
    leaves: Mapping[str, float]

    def remaining(self, parts: Parts) -> float:
        """Standard deviation of a budget that then remains [1]; a stated mass stays as it is."""
        weighed = parts.get("mass", 0.0) < _NOT_STATED
        shares = {p: s for p, s in self.leaves.items() if not (p == "mass" and weighed)}
        return math.hypot(*(x * shares.get(part, 1.0) for part, x in parts.items()))


_NOT_STATED = 0.99 * Vehicle.mass_tolerance
"""Standard deviation of a mass [1] below which it was weighed, or the file has its tolerance."""


_ADVICE = tuple(
    _Advice(row.pop("do"), row.pop("budget"), {part: float(x) for part, x in row.items() if x})
    for row in rows("budget.csv", "calib.table")
)


def ramp_pads(table: Table) -> tuple[str, str]:
    """Pad friction of front and rear from the ramp, each with its 95 % interval, in words."""
    cal = table.calibration
    front, rear = (
        plus_minus(pad.value, pad.ci95[1] - pad.value)
        for pad in (cal.pad_friction_f, cal.pad_friction_r)
    )
    return front, rear


def per_run(variances: _Variances) -> float:
    """Variance of the parts that differ from run to run."""
    return sum(variances.get(part, 0.0) for part in PER_RUN)


def shared(variances: _Variances) -> dict[str, float]:
    """The parts that are common to all runs and to the cars of a line."""
    return {part: x for part, x in variances.items() if part not in PER_RUN}


def deviations(variances: _Variances) -> Parts:
    """Standard deviation of each part that is not zero."""
    return {part: math.sqrt(x) for part, x in variances.items() if x > 0.0}


def words(parts: Parts) -> str:
    r"""The three largest parts, as a 95 % interval has them.

    >>> words({"tyres": 0.01, "mass": 0.03, "load_geometry": 0.002})
    'mass ±5.9\xa0%, tyres ±2.0\xa0%, load geometry ±0.4\xa0% (95\xa0%)'
    """
    ordered = sorted(parts.items(), key=lambda one: -one[1])[:3]
    widths = (f"{_label(part)} ±{100.0 * Z95 * x:.1f}{NBSP}%" for part, x in ordered)
    return f"{', '.join(widths)} (95{NBSP}%)"


def _label(part: str) -> str:
    return "ratio of front to rear pads" if part == "unlike_pads" else part.replace("_", " ")


def limiting(axles: Sequence[Parts]) -> str:
    r"""The largest part of each axle, as a 95 % interval.

    >>> limiting([{"tyres": 0.01, "mass": 0.03}, {"unlike_pads": 0.04}])
    'mass (±6\xa0% front), ratio of front to rear pads (±8\xa0% rear)'
    """
    by_part: dict[str, list[str]] = {}
    for axle, parts in zip(AXLE_NAMES.values(), axles, strict=True):
        most = max(parts, key=parts.__getitem__)
        width = f"±{100.0 * Z95 * parts[most]:.0f}{NBSP}%"
        by_part.setdefault(_label(most), []).append(f"{width} {axle}")
    return ", ".join(f"{part} ({', '.join(of)})" for part, of in by_part.items())


def advice_lines(axles: Iterable[Parts], kind: str = RAMP) -> list[str]:
    """What narrows the 95 % intervals, and by how much, the most useful first.

    ``axles`` budgets of front and rear pads in turn; the widest of each counts. The shares of
    `budget.csv` are tested on the reference car in `tests/fitting/test_advice.py`.

    >>> advice_lines([{"mass": 0.005, "noise": 0.02}, {"mass": 0.005, "noise": 0.04}])
    ['brake twice as long: front ±4 % -> ±3 %, rear ±8 % -> ±6 %']
    """
    budgets = list(axles)
    widest = [max(side, key=_sigma) for side in (budgets[::2], budgets[1::2]) if side]
    lines = []
    for advice in _useful(kind):
        reduced = [advice.remaining(parts) for parts in widest]
        widths = [
            (axle, *(f"±{100.0 * Z95 * x:.0f} %" for x in (_sigma(parts), after)))
            for axle, parts, after in zip(AXLE_NAMES.values(), widest, reduced, strict=False)
        ]
        if gains := [f"{axle} {a} -> {b}" for axle, a, b in widths if a != b]:
            lines.append((math.prod(reduced), f"{advice.do}: {', '.join(gains)}"))
    return [line for _, line in sorted(lines)]


def by_axle(axles: Iterable[Parts]) -> dict[str, Parts]:
    """The parts of both axles by their names, for a JSON file."""
    return dict(zip(AXLE_NAMES.values(), axles, strict=True))


def _useful(kind: str) -> list[_Advice]:
    return [advice for advice in _ADVICE if advice.budget in ("", kind)]


def _sigma(parts: Parts) -> float:
    return math.hypot(*parts.values())


def axle_parts(
    vehicle: Vehicle, log_ratio: float, level: _Variances, ratio: _Variances
) -> tuple[Parts, Parts]:
    """Parts of front and rear pads, from those of their ``level`` and their ``ratio``.

    The ratio (``log_ratio`` as of `front_share`) changes the pads of an axle by the share of the
    other one in the brake force.
    """
    share = front_share(vehicle, log_ratio)
    front, rear = (
        {p: level.get(p, 0.0) + lever**2 * ratio.get(p, 0.0) for p in {**level, **ratio}}
        for lever in (1.0 - share, share)
    )
    return deviations(front), deviations(rear)


class PadLevels(NamedTuple):
    """Logarithms [1] over the pads of the vehicle file.

    ``level`` of the brake force of both axles per pressure; ``ratio`` of the pads, front over rear.
    """

    level: float
    ratio: float


def grade(vehicle: Vehicle) -> float:
    """Standard deviation of ln of the pads' level, relative to the file, by their grade [1]."""
    return vehicle.front.pad_friction_tolerance or CAR.log_pad_ratio.sigma / math.sqrt(2.0)


def pad_levels(vehicle: Vehicle, pads: Calibration) -> PadLevels:
    """Level and ratio of the pads of a calibration."""
    front = pads.pad_friction_f.value / vehicle.front.pad_friction
    rear = pads.pad_friction_r.value / vehicle.rear.pad_friction
    share = front_share(vehicle, 0.0)
    return PadLevels(math.log(share * front + (1.0 - share) * rear), math.log(front / rear))


def pad_scale(vehicle: Vehicle, levels: PadLevels) -> float:
    """Common factor on the pads of the vehicle file [1]; with the ratio it gives both axles."""
    share, half = front_share(vehicle, 0.0), math.exp(0.5 * levels.ratio)
    return math.exp(levels.level) / (share * half + (1.0 - share) / half)
