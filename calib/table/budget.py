"""The uncertainty of a pad friction, divided into parts by cause, and advice that reduces it.

A part, such as `mass`, is what one cause contributes to the standard deviation of ln of the pad
friction; all parts of an axle are its budget. Errors of areas and radii of the brakes do not count.

The level of the pads is the brake force of both axles per pressure, their ratio is front over rear
pad friction, both relative to the vehicle file.
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

Parts = dict[str, float]  # standard deviation of ln of a pad friction [1], by part
_Variances = Mapping[str, float]  # variance of ln of the pads' level or ratio [1], by part
PER_RUN = ("noise", "zeros")
"""Parts that differ from run to run of a car. Any other part, such as mass or road, counts as one
error common to all cars of a model; if it differs, the scatter between the cars contains it."""
RAMP, STOP = "ramp", "stop"  # kinds of a budget: of a fit, of a stop
_WEIGHED = 0.99 * Vehicle.mass_tolerance  # sigma of a mass below which the car was weighed [1]


@dataclass(frozen=True)
class _Advice:
    """Advice ``do`` for a kind of ``budget`` ("" for both), and what remains if it is followed."""

    do: str
    budget: str
    remaining_shares: Mapping[str, float]  # of a part [1], by part; 1 for the parts not named

    def remaining(self, parts: Parts) -> float:
        """Standard deviation [1] of a budget with this advice; a weighed mass does not improve."""
        shares = dict(self.remaining_shares)
        if parts.get("mass", 0.0) < _WEIGHED:
            shares.pop("mass", None)
        return math.hypot(*(x * shares.get(part, 1.0) for part, x in parts.items()))


def _read(row: dict[str, str]) -> _Advice:
    shares = {part: float(x) for part, x in row.items() if x and part not in ("do", "budget")}
    return _Advice(row["do"], row["budget"], shares)


_ADVICE = tuple(map(_read, rows("budget.csv", "calib.table")))


def ramp_pads(table: Table) -> tuple[str, str]:
    """Text of front and rear pad friction from the ramp, each with its 95 % interval."""
    pads = table.calibration.pad_friction_f, table.calibration.pad_friction_r
    front, rear = (plus_minus(x.value, x.ci95[1] - x.value) for x in pads)
    return front, rear


def per_run(variances: _Variances) -> float:
    """Sum of the variances of the parts `PER_RUN`."""
    return sum(variances.get(part, 0.0) for part in PER_RUN)


def shared(variances: _Variances) -> dict[str, float]:
    """The variances of all parts but `PER_RUN`."""
    return {part: x for part, x in variances.items() if part not in PER_RUN}


def deviations(variances: _Variances) -> Parts:
    """Standard deviation of each part that is not zero."""
    return {part: math.sqrt(x) for part, x in variances.items() if x > 0.0}


def parts_text(parts: Parts) -> str:
    r"""Text of the three largest parts, as half widths of 95 % intervals.

    >>> parts_text({"tyres": 0.01, "mass": 0.03, "load_geometry": 0.002})
    'mass ±5.9\xa0%, tyres ±2.0\xa0%, load geometry ±0.4\xa0% (95\xa0%)'
    """
    largest = sorted(parts, key=lambda part: -parts[part])[:3]
    widths = (f"{_label(part)} ±{100.0 * Z95 * parts[part]:.1f}{NBSP}%" for part in largest)
    return f"{', '.join(widths)} (95{NBSP}%)"


def _label(part: str) -> str:
    return "ratio of front to rear pads" if part == "unlike_pads" else part.replace("_", " ")


def limiting_parts(axles: Sequence[Parts]) -> str:
    r"""Text of the largest part of each axle, as half widths of 95 % intervals.

    >>> limiting_parts([{"tyres": 0.01, "mass": 0.03}, {"unlike_pads": 0.04}])
    'mass (±6\xa0% front), ratio of front to rear pads (±8\xa0% rear)'
    """
    widths: dict[str, list[str]] = {}
    for axle, parts in zip(AXLE_NAMES.values(), axles, strict=True):
        largest = max(parts, key=parts.__getitem__)
        width = f"±{100.0 * Z95 * parts[largest]:.0f}{NBSP}% {axle}"
        widths.setdefault(_label(largest), []).append(width)
    return ", ".join(f"{part} ({', '.join(texts)})" for part, texts in widths.items())


def advice_lines(axles: Iterable[Parts], kind: str = RAMP) -> list[str]:
    """Return advice that narrows the 95 % intervals, and by how much, the most useful first.

    ``axles`` are budgets of front and rear pads in turn; the widest of each axle counts. The test
    `tests/fitting/test_advice.py` holds the shares of `budget.csv` to the reference car.

    >>> advice_lines([{"mass": 0.005, "noise": 0.02}, {"mass": 0.005, "noise": 0.04}])
    ['brake twice as long: front ±4 % -> ±3 %, rear ±8 % -> ±6 %']
    """
    budgets = list(axles)
    front, rear = budgets[::2], budgets[1::2]
    widest = [max(axle, key=_sigma) for axle in (front, rear) if axle]
    lines = []
    for advice in _ADVICE:
        reduced = [advice.remaining(parts) for parts in widest]
        gains = []
        for axle, parts, sigma in zip(AXLE_NAMES.values(), widest, reduced, strict=False):
            now, then = _half_width(_sigma(parts)), _half_width(sigma)
            if now != then:
                gains.append(f"{axle} {now} -> {then}")
        if gains and advice.budget in ("", kind):
            lines.append((math.prod(reduced), f"{advice.do}: {', '.join(gains)}"))
    return [line for _, line in sorted(lines)]


def _sigma(parts: Parts) -> float:
    return math.hypot(*parts.values())


def _half_width(sigma: float) -> str:
    return f"±{100.0 * Z95 * sigma:.0f} %"


def by_axle(axles: Iterable[Parts]) -> dict[str, Parts]:
    """The parts by the name of the axle, for a JSON file."""
    return dict(zip(AXLE_NAMES.values(), axles, strict=True))


def axle_parts(
    vehicle: Vehicle, log_ratio: float, level: _Variances, ratio: _Variances
) -> tuple[Parts, Parts]:
    """Parts of front and rear pads, from the variances of ``level`` and ``ratio`` of the pads.

    With the front axle's share phi of the brake force, an error d of ln of the ratio moves ln of
    the front pads by (1 - phi) d and ln of the rear pads by -phi d; an error of the level moves
    both. The errors of level and ratio count as independent. ``log_ratio`` is as in `front_share`.
    """
    share = front_share(vehicle, log_ratio)

    def of_axle(other_share: float) -> Parts:
        by_ratio = {part: other_share**2 * variance for part, variance in ratio.items()}
        names = {**level, **ratio}
        return deviations({p: level.get(p, 0.0) + by_ratio.get(p, 0.0) for p in names})

    return of_axle(1.0 - share), of_axle(share)


class LevelAndRatio(NamedTuple):
    """ln of the ``level`` and of the ``ratio`` of the pads, relative to the vehicle file [1]."""

    level: float
    ratio: float


def grade_sigma(vehicle: Vehicle) -> float:
    """Standard deviation of ln of the friction of a grade of pads [1].

    It is the tolerance of the front pads in the file, else the usual standard deviation of ln of
    the pads' ratio over sqrt(2), since that is the ratio of two grades, one for each axle. With one
    grade on both axles it is that of the level, too.
    """
    tolerance = vehicle.front.pad_friction_tolerance
    return CAR.log_pad_ratio.sigma / math.sqrt(2.0) if tolerance is None else tolerance


def level_and_ratio(vehicle: Vehicle, pads: Calibration) -> LevelAndRatio:
    """Return level and ratio of the pads of a calibration, by (2) for both axles."""
    front = pads.pad_friction_f.value / vehicle.front.pad_friction
    rear = pads.pad_friction_r.value / vehicle.rear.pad_friction
    share = front_share(vehicle, 0.0)
    return LevelAndRatio(math.log(share * front + (1.0 - share) * rear), math.log(front / rear))


def pad_scale(vehicle: Vehicle, pads: LevelAndRatio) -> float:
    """Factor s [1]: pads are s exp(ratio/2) in front, s exp(-ratio/2) behind, times the file's."""
    share, factor = front_share(vehicle, 0.0), math.exp(0.5 * pads.ratio)
    return math.exp(pads.level) / (share * factor + (1.0 - share) / factor)
