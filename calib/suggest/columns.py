"""The numeric columns of a log, physical tests for them, and the state of the search.

speed        the four wheels and the car agree
a_x          is the derivative of speed, up to a sign
pressure     rises and falls with the deceleration
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.names import AXLES, CHANNELS, TRUTH
from calib.base.units import from_si, is_unit, si_of, to_si
from calib.logs.channel_map import Mapping
from calib.logs.source import Column, ColumnSource, address_of
from calib.run.filters import centred_mean, samples_in

SMOOTH = 0.2  # width [s] over which a speed is smoothed before it is differentiated
_LAG = 0.5  # longest lag that is tried [s]: a brake builds up in 0.1 to 0.2 s
_TOGETHER, _RATIO = 0.99, 0.1
"""Lowest correlation of two wheels, and largest relative difference of their means [1]."""


@dataclass(frozen=True)
class Series:
    """A numeric column (n,) in SI, or as written where ``si`` is None: its unit is not known.

    ``name`` is the address that only this column has, ``rate`` [Hz] None if that of the rows.
    """

    name: str
    column: Column
    values: Array
    si: str | None
    rate: float | None = None


def read_series(source: ColumnSource) -> tuple[list[Series], list[Series], dict[str, str]]:
    """The columns with a number in every row, those with gaps, and for the others the reason."""
    complete, gapped, unused = list[Series](), list[Series](), dict[str, str]()
    for index, (column, values) in enumerate(zip(source.columns, source.each(), strict=True)):
        name = address_of(column, source.columns)
        if isinstance(values, LogError):
            unused[name] = values.problem
        elif column.name.startswith(TRUTH):
            unused[name] = "truth of a simulation"
        elif np.isnan(values).all():
            unused[name] = "empty"
        elif np.isinf(values).any():
            unused[name] = "has infinite values"
        else:
            si, unit, channel = None, column.unit or "", CHANNELS.get(column.name)
            if channel and is_unit(unit, channel.si):  # `Hz` on a wheel is an angular speed
                si = channel.si
            elif is_unit(unit):
                si = si_of(unit)
            values = to_si(values, unit, si) if si else values
            item = Series(name, column, values, si, source.rates.get(index))
            (gapped if np.isnan(values).any() else complete).append(item)
    return complete, gapped, unused


def rising(time: Array) -> NDArray[np.bool_]:
    """Mask of the rows that do not repeat the time before them, shape (n,)."""
    return np.append(True, np.diff(time) > 0.0) if time.size else np.zeros(0, bool)


class ColumnClock(NamedTuple):
    """Time of each row [s], shape (n,), and the mean step [s]."""

    time: Array
    step: float

    def width(self, seconds: float) -> int:
        """Number of samples in ``seconds`` [s], at least 1."""
        return samples_in(seconds, self.step)

    def smooth(self, x: Array) -> Array:
        """The mean of x (n,) over `SMOOTH`."""
        return centred_mean(x, self.width(SMOOTH) | 1)

    def rate_of(self, speed: Array) -> Array:
        """Derivative of a speed, smoothed over `SMOOTH` [unit/s]."""
        return self.smooth(np.gradient(self.smooth(speed), self.time))


def together(four: list[Array]) -> bool:
    """Whether four speeds are of one car: similar means, high correlation."""
    means = [float(np.mean(x)) for x in four]
    if min(means) <= 0.0 or max(means) > (1.0 + _RATIO) * min(means):
        return False
    if any(np.ptp(x) == 0.0 for x in four):
        return False
    steady = max(float(np.std(x)) for x in four) < 0.02 * max(means)  # constant: no correlation
    return steady or float(np.corrcoef(four).min()) > _TOGETHER


def correlation(a: Array, b: Array) -> float:
    """Correlation of ``a`` and ``b``, both (n,) [1]; 0 if one of them is constant."""
    if np.ptp(a) == 0.0 or np.ptp(b) == 0.0:
        return 0.0
    return float(np.corrcoef(a, b)[0, 1])


def follows(x: Array, rate: Array, clock: ColumnClock) -> float:
    """Correlation of x with the derivative of speed at the best lag, with its sign [1]."""
    first, n = clock.smooth(x), x.size
    reach = min(clock.width(_LAG), n // 4)
    lagged = (
        correlation(first[max(0, -k) : n - max(0, k)], rate[max(0, k) : n - max(0, -k)])
        for k in range(-reach, reach + 1)
    )
    return max(lagged, key=abs)


Radii = tuple[float, float]
"""Radii [m] of front and rear wheels, with which a car computes speeds at the rim."""
GIVE_RADIUS = (
    "give the radius with which the car computes them: --radius 0.31, twice where front and rear "
    "have others"
)

SURE, LIKELY = "sure", "likely"
"""Sure: name, unit and physics agree. Likely: one is missing, and none contradicts."""


@dataclass(frozen=True)
class Proposal:
    """Source of one channel, how ``sure`` it is, and the ``reasons`` in words."""

    channel: str
    mapping: Mapping
    sure: str
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class Doubt:
    """A question that only the user can answer: ``candidates`` for ``channel``, and ``why``."""

    channel: str
    candidates: tuple[str, ...]
    why: str
    do: str

    def __str__(self) -> str:
        names = f": {', '.join(self.candidates)}" if self.candidates else ""
        return f"{self.why}{names}; {self.do}"


def rim_mapping(channel: str, source: str, unit: str | None, radii: Radii | None) -> Mapping | None:
    """The mapping of a wheel speed that is written as a speed at the rim; None for any other."""
    if not channel.startswith("omega_") or not unit or radii is None or not is_unit(unit, "m/s"):
        return None
    radius = radii[AXLES.index(channel[6])]
    return Mapping(source, "rad/s", scale=to_si(1.0, unit, "m/s") / radius)


@dataclass
class Search:
    """State of the search; columns that are proposed or in ``unused`` are settled."""

    series: list[Series]
    gapped: list[Series]
    unused: dict[str, str]
    user_specified: dict[str, str]
    radii: Radii | None
    proposals: dict[str, Proposal] = field(default_factory=dict)
    doubts: list[Doubt] = field(default_factory=list)
    clock: ColumnClock | None = None

    def free(self) -> list[Series]:
        """Columns that are neither proposed nor refused."""
        proposed = {p.mapping.source for p in self.proposals.values()}
        return [s for s in self.series if s.name not in proposed and s.name not in self.unused]

    def refuse(self, item: Series, why: str) -> None:
        """Leave a column out, with the reason."""
        self.unused.setdefault(item.name, why)

    def propose(self, channel: str, mapping: Mapping, sure: bool, *reasons: str) -> None:
        """Propose a channel that the user did not give."""
        if channel not in self.user_specified:
            self.proposals[channel] = Proposal(channel, mapping, SURE if sure else LIKELY, reasons)

    def doubt(self, channel: str, candidates: list[Series], why: str, do: str) -> None:
        """Ask about a channel that the user did not give."""
        if channel not in self.user_specified:
            self.doubts.append(Doubt(channel, tuple(s.name for s in candidates), why, do))

    def values_of_user(self, channel: str) -> Array | None:
        """The values [SI] of the column that the user gave for a channel, or None."""
        proposal = self.proposals.get(channel)
        source = proposal.mapping.source if proposal else None
        item = next((s for s in self.series if s.name == source), None)
        if proposal is None or item is None:
            return None
        mapping, values = proposal.mapping, item.values
        if mapping.unit is None:
            return values
        # A given unit overrides the file's: undo that conversion, then apply the given one.
        written = from_si(values, str(item.column.unit), item.si) if item.si else values
        return to_si(mapping.in_unit(written), mapping.unit, CHANNELS[channel].si)
