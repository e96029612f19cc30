"""Make the maps of a table: the pads' ratio over z, eta and slip, which an ECU measures.

    draws of the car, `beliefs.csv` --scenarios--> stops --predict_stops--> eta, slip --> maps

A scenario is one stop: a draw of the car, and a draw of road, load and sensors from `beliefs.csv`.
Its eta - 1 and slip are predicted at each deceleration. A cell of the pad map has quantiles of the
pads' ratio over the scenarios, each weighed by the likelihood of eta and slip of the cell. The
level map has quantiles of the ratio without eta and slip, and quantiles of the level.
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

_SCENARIOS = 16384  # number of stops
_EVEN = (
    "log_pad_ratio case", "log_pad_ratio", "road", "log_peak", "log_stiffness", "log_tyre_f",
    "log_tyre_r", "log_mass case", "log_mass", "a_x_scale", "a_x_offset",
)  # fmt: skip
"""Names of random numbers that share one even sequence, a dimension each; another order gives other
tables. Any other quantity has numbers of its own, so that a new row of `beliefs.csv` changes no
other quantity. The number ``road`` chooses the case of both peak and stiffness."""
_Z = np.array([0.06, 0.1, 0.15, 0.22, 0.32, 0.45, 0.6, 0.85])  # demanded force over weight [1]
_SHIFTS = 21  # number of values of the shift (eta - 1)/z
_SLIP = np.array([-2.25, -0.75, 0.75, 2.25])  # ln(slip/z) less its mean [sigma]; 2 is near a peak
_QUANTILES = (0.025, 0.5, 0.975)
_DENSE = 0.004  # shift up to which its values stand evenly, beyond in equal ratios [1]
_AXIS_ENDS = (0.005, 0.995)  # quantiles of the scenarios at which the axis of shifts ends
_FINEST = 4e-5  # least error of eta - 1 [1]
_FORM = 0.01  # relative error of eta - 1 besides the discrepancy of the tyre in the draws [1]
_PER_Z = 6e-4  # error of the shift [1]: half the width of a cell
_NEAR = 0.4  # width of the kernel along the slip, in standard deviations of ln(slip/z)
_EMPTY = 0.1  # weight that all scenarios together have in a cell, for cells with no stop near
_GROUPS = 256  # groups of scenarios with similar ratios, in which weights are summed
_CHUNKS = 32  # parts of the scenarios, so that their weights fit into a processor's cache
_LEAST = -60.0  # ln of a weight that changes nothing; denormal products would be slow

_ROADS = [dict(zip(x.cases, x.share, strict=True)) for x in (STOP.log_peak, STOP.log_stiffness)]
if _ROADS[0] != _ROADS[1]:
    raise ValueError(f"peak and stiffness need the same roads with the same shares: {_ROADS}")


@dataclass(frozen=True)
class _Scenarios:
    """Equally likely stops (n,): the car of each, and how the stop differs from the ramp [1]."""

    cars: Ensemble
    change: Array  # of ln of the pads' ratio
    peak: Array  # of the road, over that of the ramp
    stiffer: Array  # ln of the tyres' stiffness over that on the ramp, by axle (2, n)
    scale: Array  # relative error of a_x, pitch included
    offset: Array  # of a_x since the lead-in [g]
    log_mass: Array  # ln of the mass over that of the file

    @property
    def log_pad_ratio(self) -> Array:
        """ln of the pads' ratio in the stop, over that of the vehicle file (n,) [1]."""
        return self.cars.log_pad_ratio + self.change

    def log_level(self, z: float) -> Array:
        """Return ln of the brake force over that by ``z`` and the mass of the file, (n,) [1]."""
        return np.asarray(np.log(np.maximum(1.0 - self.offset / z, 0.05)) + self.log_mass)


def scenarios(car: Vehicle, e: Ensemble, count: int = _SCENARIOS) -> _Scenarios:
    """Draw ``count`` stops of the cars ``e``, always the same.

    A car that was weighed, according to its file, has no unknown load.
    """
    from scipy.special import ndtri

    even: dict[str, Array] = dict(zip(_EVEN, spread_evenly(count, len(_EVEN)).T, strict=True))

    def uniform(name: str) -> Array:
        """Return numbers (n,), even in (0, 1), that belong to a name."""
        if name in even:
            return even[name]
        order = np.random.default_rng(crc32(name.encode())).permutation(count)
        return np.asarray((order + 0.5) / count)

    def drawn(name: str, case: str = "", axle: str = "") -> Array:
        """Return draws (n,) of a quantity; the numbers of the name ``case`` choose its case."""
        mixture: Mixture = getattr(STOP, name)
        return mixture.drawn(uniform(case or f"{name}{axle} case"), ndtri(uniform(name + axle)))

    cars = e.take(np.arange(count) % e.size)
    log_peak, stiffer = (drawn(name, "road") for name in ("log_peak", "log_stiffness"))
    # the peak of another road is drawn as absolute value, and changes the stiffness
    other = STOP.log_peak.is_case("other road", uniform("road"))
    log_peak -= other * np.log(cars.peak)
    stiffer += STIFFENING * other * (log_peak + np.log(cars.peak / DRY_PEAK))
    as_stated = STOP.log_mass.is_case("as stated", uniform("log_mass case"))
    weighed = car.mass_tolerance * ndtri(uniform("log_mass"))
    return _Scenarios(
        cars=cars,
        change=drawn("log_pad_ratio"),
        peak=np.exp(log_peak),
        stiffer=stiffer + np.stack([drawn("log_tyre", axle=f"_{axle}") for axle in AXLES]),
        scale=drawn("a_x_scale"),
        offset=drawn("a_x_offset"),
        log_mass=np.where(as_stated | (car.mass_tolerance <= WEIGHED), weighed, drawn("log_mass")),
    )


def predict_stops(
    car: Vehicle, s: _Scenarios, z: Array, odds: Array | float = 0.0
) -> SlipPrediction:
    """Predict eta and slips of the stops at measured decelerations ``z`` (k,) less their zero [1].

    ``odds`` (k,) is ln of the front pressure over the rear one [1].
    """
    return predict_slips(
        car,
        s.cars,
        s.log_pad_ratio[:, None] + odds,
        (z - s.offset[:, None]) * (1.0 - s.scale[:, None]),
        z,
        peak=s.peak,
        softer=np.exp(-s.stiffer)[..., None],
    )


def pressure_odds(runs: list[RampRun]) -> Array:
    """Return ln of the front pressure over the rear one [1] at `_Z` (k,), on ramps of both axles.

    It is 0 unless a known valve or logged wheel pressures make the pressures differ.
    """
    braked = [(run.blocks, run.braked) for run in runs]
    columns = np.hstack([np.stack([b.z, b.p_f, b.p_r])[:, use] for b, use in braked])
    z, p_f, p_r = columns[:, np.argsort(columns[0])]
    rows = np.stack([z, np.log(np.maximum(p_f, 1.0) / np.maximum(p_r, 1.0))])
    groups = np.array_split(rows, min(20, z.size), axis=1)
    z_means, odds_means = np.transpose([group.mean(axis=1) for group in groups])
    return np.asarray(np.interp(_Z, z_means, odds_means))


def maps(car: Vehicle, e: Ensemble, odds: Array | float = 0.0) -> tuple[PadMap, LevelMap]:
    """Return the map of the pads' ratio by eta and slip, and that of level and ratio without them.

    ``odds`` (k,) of `pressure_odds` are added to the ratio, so the maps have the ratio of the brake
    forces.
    """
    s = scenarios(car, e)
    predicted = predict_stops(car, s, _Z, odds)
    at_z = list(zip(_Z, predicted.eta_rise.T, predicted.slip.T, predicted.rolls.T, strict=True))
    # arcsinh is even near 0 and logarithmic beyond `_DENSE`
    ends = [np.quantile(np.arcsinh(x[rolls] / z / _DENSE), _AXIS_ENDS) for z, x, _, rolls in at_z]
    shifts = _DENSE * np.sinh(np.linspace(np.min(ends), np.max(ends), _SHIFTS))
    orders = [np.argsort(x) for x in (s.log_pad_ratio, s.change)]
    pad_rows, level_rows = [], []  # columns of the maps at each z
    for stops, odds_at_z in zip(at_z, np.broadcast_to(odds, _Z.shape), strict=True):
        z, eta_rise, slip, rolls = stops
        targets = np.stack([s.log_pad_ratio + odds_at_z, s.change])
        cells, unread = _cells(z, eta_rise, slip, rolls, shifts, targets, orders)
        level = np.quantile(s.log_level(z), _QUANTILES)
        pad_rows.append(cells)
        level_rows.append(unread | _bounded("level", level))
    pads = PadMap.from_grids((_Z, shifts, _SLIP), **_stacked(pad_rows))
    return pads, LevelMap.from_grids((_Z,), **_stacked(level_rows))


def _stacked(rows: Sequence[dict[str, Array]]) -> dict[str, Array]:
    """Return the columns of a map from its ``rows``, one for each z."""
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def _cells(
    z: float,
    eta_rise: Array,
    slip: Array,
    rolls: Mask,
    shifts: Array,
    targets: Array,
    orders: Sequence[Index],
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return columns of the pad map (a, 4) at ``z``, and of the level map there.

    ``eta_rise``, ``slip`` and ``rolls`` (n,) of the scenarios are those of `SlipPrediction`. Each
    of ``shifts`` (a,) has four cells, for `_SLIP`. ``targets`` are ratio and change of the pads
    (2, n), and ``orders`` the orders in which they rise.
    """
    counts = rolls[:, None].astype(float)
    least = _EMPTY / rolls.size * counts
    error = np.sqrt((_FORM * eta_rise) ** 2 + _FINEST**2 + (_PER_Z * z) ** 2)[:, None]
    near = _gauss((eta_rise[:, None] - shifts * z) / error) / error * counts  # weights (n, a)
    share = near.sum(axis=0) * np.gradient(shifts)
    near += least * np.max(near)
    # ln(slip/z) is nearly normal at each shift: mean and sigma (a,)
    log_slip = np.log(np.maximum(slip, 1e-4) / z)
    means, variances = _moments(near, log_slip[None])
    mean, sigma = means[:, 0], np.maximum(np.sqrt(variances[:, 0, 0]), 0.02)
    # weights (n, 1 + 4 a): first those without eta and slip, then those in each cell
    weights = _cell_weights(counts, near, (log_slip[:, None] - mean) / sigma, least)
    columns = {"log_slip": mean, "log_slip_sigma": sigma, "share": share / share.sum()}
    cells = {name: np.repeat(x[:, None], _SLIP.size, axis=1) for name, x in columns.items()}
    # A cell is wide in ln(slip), and the ratio is nearly linear in it. The quantiles of a cell are
    # moved along that line to the middle of the cell, and narrowed by the scatter of the line.
    means, joint = (x[1:] for x in _moments(weights, np.vstack([log_slip, targets])))
    to_middle = (mean[:, None] + sigma[:, None] * _SLIP).ravel() - means[:, 0]
    unread: dict[str, Array] = {}
    for k, (name, x) in enumerate(zip(("ratio", "change"), targets, strict=True), 1):
        of_all, *of_cells = _quantiles(x, orders[k - 1], weights)
        slope, spread = joint[:, 0, k] / joint[:, 0, 0], np.array(of_cells)
        narrowed = np.sqrt(1.0 - slope * joint[:, 0, k] / joint[:, k, k])[:, None]
        median = spread[:, 1:2]
        within = median + narrowed * (spread - median) + (slope * to_middle)[:, None]
        cells |= _bounded(name, within.reshape(shifts.size, _SLIP.size, 3))
        unread |= _bounded(name, of_all)
    width, prior_width = (x["ratio_upper"] - x["ratio_lower"] for x in (cells, unread))
    return cells | {"prior": np.minimum(width / prior_width, 1.0)}, unread


def _cell_weights(counts: Array, near: Array, deviation: Array, least: Array) -> Array:
    """Return ``counts`` (n, 1), then the weights in the cells of all shifts: (n, 1 + 4 a).

    Each shift has the four cells of `_SLIP`. ``near`` (n, a) are the weights by the shift,
    ``deviation`` (n, a) of ln(slip/z) is from its mean [standard deviations], and every scenario
    has the weight ``least`` (n, 1) in every cell.
    """
    weights = np.empty((len(near), 1 + near.shape[1] * _SLIP.size))
    weights[:, :1] = counts
    more, size = least * np.max(near), len(near) // _CHUNKS
    for start in range(0, len(near), size):
        rows = slice(start, start + size)
        for place, middle in enumerate(_SLIP / _NEAR, 1):
            weight = _gauss(deviation[rows] / _NEAR - middle)
            weight *= near[rows]
            np.add(weight, more[rows], out=weights[rows, place :: _SLIP.size])
    return weights


def _quantiles(x: Array, order: Index, weights: Array) -> Array:
    """Return `_QUANTILES` (c, 3) of ``x`` (n,) with ``weights`` (n, c) of c cells.

    ``order`` is the order in which ``x`` rises. In it the weights are summed over `_GROUPS`, in
    which the quantile is linear.
    """
    size = x.size // _GROUPS
    groups = order[: size * _GROUPS].reshape(_CHUNKS, -1, size)  # (chunk, group, scenario)
    edges = np.append(x[groups[..., 0]], x[groups[-1, -1, -1]])
    sums = [np.ones(size) @ weights.take(chunk, axis=0) for chunk in groups]
    below = np.cumsum(np.concatenate(sums), axis=0)
    below = np.concatenate([np.zeros_like(below[:1]), below / below[-1]])
    return np.stack([np.interp(_QUANTILES, column, edges) for column in below.T])


def _gauss(x: Array) -> Array:
    """Return exp(-x^2/2), written into ``x``, since the arrays are large."""
    x *= x
    x *= -0.5
    return np.exp(np.maximum(x, _LEAST, out=x), out=x)


def _moments(weight: Array, x: Array) -> tuple[Array, Array]:
    """Return means (c, k), covariances (c, k, k) of k quantities ``x`` (k, n) by weights (n, c)."""
    centre, k = x.mean(axis=1), len(x)
    deviation = x - centre[:, None]
    squares = (deviation[:, None] * deviation).reshape(k * k, -1)
    sums = np.vstack([np.ones_like(deviation[:1]), deviation, squares]) @ weight
    moments = (sums[1:] / sums[0]).T  # (c, k + k^2)
    mean, square = moments[:, :k], moments[:, k:].reshape(-1, k, k)
    covariance = square - mean[:, :, None] * mean[:, None, :]
    return mean + centre, covariance + 1e-12 * np.eye(k)


def _bounded(name: str, x: Array) -> dict[str, Array]:
    """Return the columns of a median with its bounds, from quantiles (..., 3)."""
    return {f"{name}_lower": x[..., 0], name: x[..., 1], f"{name}_upper": x[..., 2]}
