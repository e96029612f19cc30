"""What an interval is made of: how well a pad friction is known, split by what is not known.

The page `validation` of the manual says what each part holds. Not counted: the centre of gravity,
areas and radii of the brakes, which are taken as the vehicle file has them.
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
"""Standard deviation of ln of a pad friction [1] by its cause: the squares add up to the whole."""

_Variances = Mapping[str, float]
"""The squares, of ln of pad level or ratio too."""

OWN = ("noise", "zeros")
"""Parts that another run of the same car draws anew.

All others are in every car of a line: mass, geometry, road, kind of sensor, method. What of those
is not alike (a driver's weight, one car's accelerometer) is seen as spread between cars.
"""

RAMP, STOP = "ramp", "stop"
"""Whose budget it is: of a fit, or of a stop, whose ``tyres`` are what the ramp left open."""


@dataclass(frozen=True)
class _Advice:
    """What to ``do``, and the share of each part that it leaves in a budget ``of`` one kind [1]."""

    do: str
    of: str
    leaves: Mapping[str, float]

    def left(self, parts: Parts) -> float:
        """Standard deviation of what is left of a budget [1]; a mass that was stated stays."""
        weighed = parts.get("mass", 0.0) < _NOT_STATED
        shares = {p: s for p, s in self.leaves.items() if not (p == "mass" and weighed)}
        return math.hypot(*(x * shares.get(part, 1.0) for part, x in parts.items()))


_NOT_STATED = 0.99 * Vehicle.mass_tolerance
"""A mass that is known better was weighed, or its tolerance is stated [1]."""


def _read(row: dict[str, str]) -> _Advice:
    cells = {part: cell for part, cell in row.items() if part not in ("do", "of")}
    return _Advice(row["do"], row["of"], {part: float(x) for part, x in cells.items() if x})


_ADVICE = tuple(map(_read, rows("budget.csv", "calib.table")))


def ramp_pads(table: Table) -> tuple[str, str]:
    """Pad friction of front and rear from the ramp, each with its 95 % interval, in words."""
    cal = table.calibration
    front, rear = (
        plus_minus(pad.value, pad.ci95[1] - pad.value)
        for pad in (cal.pad_friction_f, cal.pad_friction_r)
    )
    return front, rear


def own(variances: _Variances) -> float:
    """Variance by what another run of the same car would draw anew."""
    return sum(variances.get(part, 0.0) for part in OWN)


def shared(variances: _Variances) -> dict[str, float]:
    """The parts that another run of the same car, or of another car of the line, has alike."""
    return {part: x for part, x in variances.items() if part not in OWN}


def deviations(variances: _Variances) -> Parts:
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
    r"""The largest part of each axle, as a 95 % interval has it.

    >>> limiting([{"tyres": 0.01, "mass": 0.03}, {"unlike_pads": 0.04}])
    'mass (±6\xa0% front), unlike pads (±8\xa0% rear)'
    """
    told: dict[str, list[str]] = {}
    for axle, parts in zip(AXLE_NAMES.values(), axles, strict=True):
        most = largest(parts)
        width = f"±{100.0 * Z95 * parts[most]:.0f}{NBSP}%"
        told.setdefault(most.replace("_", " "), []).append(f"{width} {axle}")
    return ", ".join(f"{part} ({', '.join(of)})" for part, of in told.items())


def advice_lines(axles: Iterable[Parts], of: str = RAMP) -> list[str]:
    """What narrows the 95 % intervals, and by how much, the most useful first; [] if nothing does.

    ``axles`` budgets of front and rear pads in turn; of several the widest counts. How far the
    shares of `budget.csv` hold on the reference car is in `tests/fitting/test_advice.py`.

    >>> advice_lines([{"mass": 0.005, "noise": 0.02}, {"mass": 0.005, "noise": 0.04}])
    ['brake twice as long: front ±4 % -> ±3 %, rear ±8 % -> ±6 %']
    """
    given = list(axles)
    widest = [max(side, key=_sigma) for side in (given[::2], given[1::2]) if side]
    found = []
    for one in _useful(of):
        left = [one.left(parts) for parts in widest]
        widths = [
            (axle, *(f"±{100.0 * Z95 * x:.0f} %" for x in (_sigma(parts), after)))
            for axle, parts, after in zip(AXLE_NAMES.values(), widest, left, strict=False)
        ]
        if gains := [f"{axle} {a} -> {b}" for axle, a, b in widths if a != b]:
            found.append((math.prod(left), f"{one.do}: {', '.join(gains)}"))
    return [line for _, line in sorted(found)]


def summary(front: Parts, rear: Parts, of: str = RAMP) -> dict[str, object]:
    """Both axles for a JSON file: their parts, the largest of each, and what shrinks it."""
    axles = {"front": front, "rear": rear}
    most = {axle: largest(parts) for axle, parts in axles.items()}
    shrinks = {p: min(_useful(of), key=lambda one: one.leaves.get(p, 2.0)) for p in most.values()}
    told = {axle: {"part": p, "do": shrinks[p].do} for axle, p in most.items()}
    return {**axles, "largest": told}


def _useful(of: str) -> list[_Advice]:
    return [one for one in _ADVICE if one.of in ("", of)]


def _sigma(parts: Parts) -> float:
    return math.hypot(*parts.values())


def axle_parts(
    vehicle: Vehicle, log_ratio: float, level: _Variances, ratio: _Variances
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


class PadLevels(NamedTuple):
    """Logarithms [1], against the pads of the vehicle file.

    ``level`` of the brake force of both axles per pressure, which the sum of forces fixes;
    ``ratio`` of the pads, front over rear.
    """

    level: float
    ratio: float


def grade(vehicle: Vehicle) -> float:
    """Standard deviation of ln of the pads' level over that of the file, by their grade [1]."""
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
