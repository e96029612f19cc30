"""The numeric columns of a log, physical tests for them, and the state of the search.

The four wheel speeds agree with each other and with the speed of the car. a_x is the derivative of
the speed, up to its sign. The pressure rises and falls with the deceleration.
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.errors import LogError
from calib.base.names import AXLES, CHANNELS, TRUTH
from calib.base.units import from_si, is_unit, si_of, to_si
from calib.logs.channel_map import Mapping
from calib.logs.source import Column, ColumnSource, address_of
from calib.run.filters import centred_mean, samples_in

SMOOTH = 0.2  # width [s] over which a speed is smoothed before it is differentiated
_LAG = 0.5  # longest lag that is tried [s]: a brake builds up in 0.1 to 0.2 s
_ALIKE, _APART = 0.99, 0.1
"""Least correlation of two wheel speeds, largest relative difference of the means of four [1]."""
_STEADY = 0.02  # standard deviation over mean [1] below which noise hides the correlation


@dataclass(frozen=True)
class Series:
    """A numeric column."""

    name: str  # address that no other column has
    column: Column
    values: Array  # (n,) in the unit `si`
    si: str | None  # SI unit; None if the unit is not known and the values are as written
    rate: float | None = None  # [Hz], if the column was not recorded once in each row


def read_series(source: ColumnSource) -> tuple[list[Series], list[Series], dict[str, str]]:
    """Read the columns with a number in every row, those with gaps, and why others are unused."""
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
            si = _si_unit(column)
            values = to_si(values, str(column.unit), si) if si else values
            item = Series(name, column, values, si, source.rates.get(index))
            (gapped if np.isnan(values).any() else complete).append(item)
    return complete, gapped, unused


def _si_unit(column: Column) -> str | None:
    unit, quantity = column.unit or "", CHANNELS.get(column.name)
    if quantity and is_unit(unit, quantity.si):  # `Hz` on a wheel is an angular speed
        return quantity.si
    return si_of(unit) if is_unit(unit) else None


def is_later(time: Array) -> Mask:
    """Whether the time of each row is later than that of the row before, shape (n,)."""
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
        """Derivative of a speed (n,) [unit/s], smoothed over `SMOOTH` before and after."""
        return self.smooth(np.gradient(self.smooth(speed), self.time))


def are_of_one_car(speeds: list[Array]) -> bool:
    """Whether the speeds of four wheels, each (n,), have similar means and are correlated."""
    means = [float(np.mean(x)) for x in speeds]
    if min(means) <= 0.0 or max(means) > (1.0 + _APART) * min(means):
        return False
    if any(np.ptp(x) == 0.0 for x in speeds):
        return False
    are_steady = max(float(np.std(x)) for x in speeds) < _STEADY * max(means)
    return are_steady or float(np.corrcoef(speeds).min()) > _ALIKE


def correlation(a: Array, b: Array) -> float:
    """Correlation of ``a`` and ``b``, both (n,) [1]; 0 if one of them is constant."""
    if np.ptp(a) == 0.0 or np.ptp(b) == 0.0:
        return 0.0
    return float(np.corrcoef(a, b)[0, 1])


def best_correlation(x: Array, rate: Array, clock: ColumnClock) -> float:
    """Correlation [1] of ``x`` and the derivative of speed, (n,), at the best lag."""
    smooth, n = clock.smooth(x), x.size
    longest = min(clock.width(_LAG), n // 4)
    correlations = []
    for lag in range(-longest, longest + 1):  # sample i of x with sample i + lag of the rate
        of_x = slice(max(0, -lag), n - max(0, lag))
        of_rate = slice(max(0, lag), n - max(0, -lag))
        correlations.append(correlation(smooth[of_x], rate[of_rate]))
    return max(correlations, key=abs)


Radii = tuple[float, float]
"""Radii [m] of front and rear wheels, with which a car computes speeds at the rim."""
GIVE_RADIUS = (
    "give the radius with which the car computes them: --radius 0.31; give it twice, front then "
    "rear, if they differ"
)

SURE, LIKELY = "sure", "likely"
"""Sure: name, unit and physics agree. Likely: one of the three is missing, none contradicts."""


@dataclass(frozen=True)
class Proposal:
    """The source that is proposed for a channel."""

    channel: str
    mapping: Mapping
    sure: str  # SURE or LIKELY
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class Doubt:
    """A question on a channel that only the user can answer."""

    channel: str
    candidates: tuple[str, ...]  # names of the columns of which one may be the channel
    why: str  # cause of the doubt
    do: str  # next step of the user

    def __str__(self) -> str:
        names = f": {', '.join(self.candidates)}" if self.candidates else ""
        return f"{self.why}{names}; {self.do}"


def rim_mapping(channel: str, source: str, unit: str | None, radii: Radii | None) -> Mapping | None:
    """The mapping of a wheel speed that is written as a speed at the rim, else None."""
    if not channel.startswith("omega_") or not unit or radii is None or not is_unit(unit, "m/s"):
        return None
    radius = radii[AXLES.index(channel[6])]
    return Mapping(source, "rad/s", scale=to_si(1.0, unit, "m/s") / radius)


@dataclass
class Search:
    """State of the search."""

    series: list[Series]  # columns with a number in every row
    gapped: list[Series]  # columns with gaps
    unused: dict[str, str]  # reason against a column, by its name
    user_specified: dict[str, str]  # source by channel, as the user wrote it
    radii: Radii | None
    # by channel; those of the user are entered at the start, not by `propose`
    proposals: dict[str, Proposal] = field(default_factory=dict)
    doubts: list[Doubt] = field(default_factory=list)
    clock: ColumnClock | None = None

    def free(self) -> list[Series]:
        """Complete columns that are neither proposed nor refused."""
        proposed = {p.mapping.source for p in self.proposals.values()}
        return [s for s in self.series if s.name not in proposed and s.name not in self.unused]

    def refuse(self, item: Series, why: str) -> None:
        """Leave a column out; the first reason counts."""
        self.unused.setdefault(item.name, why)

    def propose(self, channel: str, mapping: Mapping, is_sure: bool, *reasons: str) -> None:
        """Propose a channel that the user did not give."""
        if channel not in self.user_specified:
            sure = SURE if is_sure else LIKELY
            self.proposals[channel] = Proposal(channel, mapping, sure, reasons)

    def doubt(self, channel: str, candidates: list[Series], why: str, do: str) -> None:
        """Ask about a channel that the user did not give."""
        if channel not in self.user_specified:
            self.doubts.append(Doubt(channel, tuple(s.name for s in candidates), why, do))

    def values_of_user(self, channel: str) -> Array | None:
        """The values (n,) of the column that the user gave for a channel, in SI, or None."""
        proposal = self.proposals.get(channel)
        source = proposal.mapping.source if proposal else None
        item = next((s for s in self.series if s.name == source), None)
        if proposal is None or item is None:
            return None
        mapping = proposal.mapping
        if mapping.unit is None:
            return item.values
        # A given unit overrides the file's: undo that conversion, then apply the given one.
        written = from_si(item.values, str(item.column.unit), item.si) if item.si else item.values
        return to_si(mapping.in_unit(written), mapping.unit, CHANNELS[channel].si)
