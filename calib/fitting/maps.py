r"""Make the maps of a table: the pads' ratio over z, eta and slip, which an ECU measures.

    draws of the car, `beliefs.csv` --scenarios--> stops --predict_stops--> eta, slip --> maps

A scenario is one stop: a draw of the car, and a draw of road, load and sensors from `beliefs.csv`.
It predicts eta - 1 and slip at each deceleration. A cell of the pad map has quantiles of the pads'
ratio over the scenarios, each weighed by the likelihood of eta and slip of the cell. The level map
has the quantiles without eta and slip, and those of the level.

So the bounds of a cell include what the ramps left open and what a stop may change. Where a softer
road and weak rear pads explain the same eta, the bounds include both.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from zlib import crc32

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.names import AXLES
from calib.car.beliefs import DRY_PEAK, STIFFENING, STOP, Mixture
from calib.car.mass import WEIGHED
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import Ensemble, SlipPrediction, predict_slips, spread_evenly
from calib.model.ramp import RampRun
from calib.table.maps import LevelMap, PadMap

# Each quantity of a stop has its own random numbers, by its name, so that a new row of
# `beliefs.csv` changes no other quantity. Peak and stiffness of the road share theirs.

_SCENARIOS = 16384  # number of stops
_EVEN = (
    *("log_pad_ratio case", "log_pad_ratio", "road", "log_peak", "log_stiffness", "log_tyre_f"),
    *("log_tyre_r", "log_mass case", "log_mass", "a_x_scale", "a_x_offset"),
)
"""Quantities that share one even sequence, a dimension each. Another order gives other tables."""
_ROADS = [dict(zip(x.cases, x.share, strict=True)) for x in (STOP.log_peak, STOP.log_stiffness)]
if _ROADS[0] != _ROADS[1]:
    raise ValueError(f"peak and stiffness need the same roads with the same shares: {_ROADS}")


@dataclass(frozen=True)
class _Scenarios:
    """Equally likely stops (n,): the car of each, and how the stop differs from the ramp [1].

    ``change`` of ln of the pads' ratio; ``peak`` of the road over the ramp's; ``stiff`` ln of the
    tyres' stiffness over the ramp's, by axle (2, n); ``scale`` relative error of a_x, pitch
    included; ``offset`` of a_x since the lead-in [g]; ``mass`` ln of the mass over the file's.
    """

    cars: Ensemble
    change: Array
    peak: Array
    stiff: Array
    scale: Array
    offset: Array
    mass: Array

    @property
    def log_pad_ratio(self) -> Array:
        """ln of the pads' ratio in the stop, over that of the vehicle file."""
        return self.cars.log_pad_ratio + self.change

    def level(self, z: float) -> Array:
        """ln of the true brake force over that by ``z`` and the mass of the file, (n,) [1]."""
        return np.asarray(np.log(np.maximum(1.0 - self.offset / z, 0.05)) + self.mass)


def scenarios(car: Vehicle, e: Ensemble, count: int = _SCENARIOS) -> _Scenarios:
    """Draw ``count`` stops of the cars ``e``, by a fixed sequence.

    A car that was weighed, by its file, carries no unknown load.
    """
    from scipy.special import ndtri

    even = dict(zip(_EVEN, spread_evenly(count, len(_EVEN)).T, strict=True))

    def uniform(name: str) -> Array:
        """Numbers (n,), even in (0, 1), that belong to a name."""
        return even[name] if name in even else _in_any_order(count, name)

    def drawn(name: str, case: str = "", axle: str = "") -> Array:
        """Draws (n,) of a quantity; ``case`` names the numbers that choose its case."""
        mixture: Mixture = getattr(STOP, name)
        return mixture.drawn(uniform(case or f"{name}{axle} case"), ndtri(uniform(name + axle)))

    cars = e.take(np.arange(count) % e.size)
    log_peak, stiff = (drawn(name, "road") for name in ("log_peak", "log_stiffness"))
    # the peak of another road is not relative to the ramp's, and changes its stiffness
    other = STOP.log_peak.is_case("other road", uniform("road"))
    log_peak -= other * np.log(cars.peak)
    stiff += STIFFENING * other * (log_peak + np.log(cars.peak / DRY_PEAK))
    as_stated = STOP.log_mass.is_case("as stated", uniform("log_mass case"))
    mass = car.mass_tolerance * ndtri(uniform("log_mass"))
    return _Scenarios(
        cars=cars,
        change=drawn("log_pad_ratio"),
        peak=np.exp(log_peak),
        stiff=stiff + np.stack([drawn("log_tyre", axle=f"_{axle}") for axle in AXLES]),
        scale=drawn("a_x_scale"),
        offset=drawn("a_x_offset"),
        mass=np.where(as_stated | (car.mass_tolerance <= WEIGHED), mass, drawn("log_mass")),
    )


def _in_any_order(count: int, name: str) -> Array:
    """Midpoints of ``count`` equal steps of (0, 1), in a random order with the seed ``name``."""
    order = np.random.default_rng(crc32(name.encode())).permutation(count)
    return np.asarray((order + 0.5) / count)


def predict_stops(
    car: Vehicle, s: _Scenarios, z: Array, odds: Array | float = 0.0
) -> SlipPrediction:
    """Eta and slips of the stops at decelerations ``z`` (k,) less their zero [1].

    ``odds`` (k,) is ln of the front pressure over the rear one [1]. See `predict_slips`.
    """
    return predict_slips(
        car,
        s.cars,
        s.log_pad_ratio[:, None] + odds,
        (z - s.offset[:, None]) * (1.0 - s.scale[:, None]),
        z,
        peak=s.peak,
        softer=np.exp(-s.stiff)[..., None],
    )


_Z = np.array([0.06, 0.1, 0.15, 0.22, 0.32, 0.45, 0.6, 0.85])  # demanded force over weight [1]
_SHIFTS = 21  # number of values of (eta - 1)/z
_SLIP = np.array([-2.25, -0.75, 0.75, 2.25])  # ln(slip/z) less its mean [sigma]; 2 is near a peak
_QUANTILES = (0.025, 0.5, 0.975)
_DENSE = 0.004  # (eta - 1)/z up to which its values stand evenly, beyond in equal ratios [1]
_AXIS_ENDS = (0.005, 0.995)  # quantiles of the scenarios at which the axis of (eta - 1)/z ends
_FINEST = 4e-5  # least error of eta - 1 [1]
_FORM = 0.01  # relative error of eta - 1 besides the discrepancy of the tyre in the draws [1]
_PER_Z = 6e-4  # error of eta - 1 per deceleration [1]: half the width of a cell
_NEAR = 0.4  # width of the kernel along the slip, in standard deviations of ln(slip/z)
_EMPTY = 0.1  # weight of all scenarios in every cell, in scenarios: counts where no stop is near
_GROUPS = 256  # groups of scenarios with similar ratios, in which weights are summed
_CHUNKS = 32  # parts of the scenarios, so that their weights fit into a processor's cache


def _quantiles(x: Array, order: Index, weights: Array) -> Array:
    """`_QUANTILES` of ``x`` (n,) with ``weights`` (n, c) of c cells, (c, 3), linear in a group.

    ``order`` is the order in which ``x`` rises.
    """
    size = x.size // _GROUPS
    groups = order[: size * _GROUPS].reshape(_CHUNKS, -1, size)
    edges = np.append(x[groups[..., 0]], x[groups[-1, -1, -1]])
    sums = [np.ones(size) @ weights.take(chunk, axis=0) for chunk in groups]
    below = np.cumsum(np.concatenate(sums), axis=0)
    below = np.concatenate([np.zeros_like(below[:1]), below / below[-1]])
    return np.stack([np.interp(_QUANTILES, column, edges) for column in below.T])


def pressure_odds(runs: list[RampRun]) -> Array:
    """ln of the front pressure over the rear one [1] at `_Z` (k,), on ramps of both axles.

    It is 0 unless a known valve or logged wheel pressures make them differ.
    """
    braked = [(run.blocks, run.braked) for run in runs]
    signals = [np.stack([b.z, b.p_f, b.p_r])[:, use] for b, use in braked]
    columns = np.hstack(signals)
    z, p_f, p_r = columns[:, np.argsort(columns[0])]
    rows = np.stack([z, np.log(np.maximum(p_f, 1.0) / np.maximum(p_r, 1.0))])
    groups = np.array_split(rows, min(20, z.size), axis=1)
    z_means, odds_means = np.transpose([group.mean(axis=1) for group in groups])
    return np.asarray(np.interp(_Z, z_means, odds_means))


def maps(car: Vehicle, e: Ensemble, odds: Array | float = 0.0) -> tuple[PadMap, LevelMap]:
    """The map of the pads' ratio by eta and slip, and the map of level and ratio without them.

    ``odds`` as of `pressure_odds`. They are added to the ratio, so the maps have the ratio of the
    brake forces.
    """
    s = scenarios(car, e)
    predicted = predict_stops(car, s, _Z, odds)
    at_z = list(zip(_Z, predicted.eta_rise.T, predicted.slip.T, predicted.rolls.T, strict=True))
    # arcsinh is even near 0 and logarithmic beyond `_DENSE`
    ends = [np.quantile(np.arcsinh(x[rolls] / z / _DENSE), _AXIS_ENDS) for z, x, _, rolls in at_z]
    axis = _DENSE * np.sinh(np.linspace(np.min(ends), np.max(ends), _SHIFTS))
    orders = [np.argsort(x) for x in (s.log_pad_ratio, s.change)]
    columns = []
    for slices, odds_at_z in zip(at_z, np.broadcast_to(odds, _Z.shape), strict=True):
        targets = np.stack([s.log_pad_ratio + odds_at_z, s.change])
        cells, marginal = _cells(*slices, axis, targets, orders)
        level = np.quantile(s.level(slices[0]), _QUANTILES)
        columns.append((cells, marginal | _bounded("level", level)))
    pads, unread = (
        {name: np.array([row[name] for row in rows]) for name in rows[0]}
        for rows in zip(*columns, strict=True)
    )
    return PadMap.from_grids((_Z, axis, _SLIP), **pads), LevelMap.from_grids((_Z,), **unread)


def _cells(
    z: float,
    shift: Array,
    slip: Array,
    rolls: Mask,
    axis: Array,
    targets: Array,
    orders: Sequence[Index],
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Columns of the pad map at ``z``, over ``axis`` and `_SLIP`, and of the level map there.

    Of the n scenarios: ``shift`` eta - 1, ``slip`` and ``rolls`` as in `SlipPrediction`, (n,) each;
    ``targets`` ratio and change of the pads (2, n), and the ``orders`` in which they rise. A cell
    has a place on ``axis`` (a,) and one of the four of `_SLIP`.
    """
    counts = rolls[:, None].astype(float)
    least = _EMPTY / rolls.size * counts
    error = np.sqrt((_FORM * shift) ** 2 + _FINEST**2 + (_PER_Z * z) ** 2)[:, None]
    near = _gauss((shift[:, None] - axis * z) / error) / error * counts  # (n, a)
    share = near.sum(axis=0) * np.gradient(axis)
    near += least * np.max(near)
    log_slip = np.log(np.maximum(slip, 1e-4) / z)
    middle, spread = _moments(near, log_slip[None])
    mean, sigma = middle[:, 0], np.maximum(np.sqrt(spread[:, 0, 0]), 0.02)
    apart = (log_slip[:, None] - mean) / sigma
    weights = np.empty((log_slip.size, 1 + axis.size * _SLIP.size))  # all stops, then each cell
    weights[:, :1] = counts
    more, size = least * np.max(near), log_slip.size // _CHUNKS
    for start in range(0, log_slip.size, size):
        rows = slice(start, start + size)
        for place, sigmas in enumerate(_SLIP / _NEAR, 1):
            weight = _gauss(apart[rows] / _NEAR - sigmas)
            weight *= near[rows]
            np.add(weight, more[rows], out=weights[rows, place :: _SLIP.size])
    flat = {"log_slip": mean, "log_slip_sigma": sigma, "share": share / share.sum()}
    cells = {name: np.repeat(x[:, None], _SLIP.size, axis=1) for name, x in flat.items()}
    # A cell is wide in ln(slip), and the ratio is nearly linear in it. The quantiles of a cell are
    # moved along that line to the middle of the cell, and narrowed by the scatter of the line.
    moments = _moments(weights, np.vstack([log_slip, targets]))
    middle, joint = (x[1:] for x in moments)  # of the cells
    off = (mean[:, None] + sigma[:, None] * _SLIP).ravel() - middle[:, 0]
    marginal: dict[str, Array] = {}
    for k, (name, x) in enumerate(zip(("ratio", "change"), targets, strict=True), 1):
        of_all, *of_cells = _quantiles(x, orders[k - 1], weights)
        slope, spread = joint[:, 0, k] / joint[:, 0, 0], np.array(of_cells)
        narrowed = np.sqrt(1.0 - slope * joint[:, 0, k] / joint[:, k, k])[:, None]
        within = spread[:, 1:2] + narrowed * (spread - spread[:, 1:2]) + (slope * off)[:, None]
        cells |= _bounded(name, within.reshape(axis.size, _SLIP.size, 3))
        marginal |= _bounded(name, of_all)
    width, prior_width = (x["ratio_upper"] - x["ratio_lower"] for x in (cells, marginal))
    return cells | {"prior": np.minimum(width / prior_width, 1.0)}, marginal


_LEAST = -60.0  # ln of a weight that changes nothing; denormal products would be slow


def _gauss(x: Array) -> Array:
    """``exp(-x^2/2)``, written into ``x``: the arrays are large."""
    x *= x
    x *= -0.5
    return np.exp(np.maximum(x, _LEAST, out=x), out=x)


def _moments(weight: Array, x: Array) -> tuple[Array, Array]:
    """Means (c, k) and covariances (c, k, k) of k quantities ``x`` (k, n) by weights (n, c)."""
    centre = x.mean(axis=1)
    apart, k = x - centre[:, None], len(x)
    squares = (apart[:, None] * apart).reshape(k * k, -1)
    sums = np.vstack([np.ones_like(apart[:1]), apart, squares]) @ weight
    mean, square = (sums[1:] / sums[0]).T[:, :k], (sums[1:] / sums[0]).T[:, k:]
    covariance = square.reshape(-1, k, k) - mean[:, :, None] * mean[:, None, :]
    return mean + centre, covariance + 1e-12 * np.eye(len(x))


def _bounded(name: str, x: Array) -> dict[str, Array]:
    """Columns of a median with its bounds, from quantiles (..., 3)."""
    return {f"{name}_lower": x[..., 0], name: x[..., 1], f"{name}_upper": x[..., 2]}
