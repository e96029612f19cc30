r"""The maps of a table: what the pads' ratio is, given what an ECU sees.

A scenario is a stop as `calib.car.beliefs` has them, drawn onto an ensemble, and says what the
sensors would see at a deceleration. In a cell of the map those count that would see about the cell,
by the noise that a reading has at least and by what a tyre departs from its form; their ratio of
the pads gives median and bounds of the cell.
All that the ramps left open, and all that a stop may bring, is inside: a posterior with two peaks,
a softer road or weak rear pads, has bounds that hold both.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from zlib import crc32

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.names import AXLES
from calib.car.beliefs import STOP, Mixture
from calib.car.vehicle import WEIGHED, Vehicle
from calib.fitting.ensemble import Ensemble, Shown, shown, spread_evenly
from calib.model.ramp import RampRun
from calib.table.maps import LevelMap, PadMap

# --- stops ---------------------------------------------------------------------------------------
#
# Each quantity of a stop has random numbers of its own, by its name: they hang neither on the order
# of the rows of `beliefs.csv` nor on how many there are. Only the road decides two things, its peak
# and its stiffness.

_SCENARIOS = 16384
_EVEN = (
    *("log_pad_ratio case", "log_pad_ratio", "road", "log_peak", "log_stiffness", "log_tyre_f"),
    *("log_tyre_r", "log_mass case", "log_mass", "a_x_scale", "a_x_offset"),
)
"""What is spread evenly together: each name has its dimension, and a table rests on its place."""
_ROADS = [dict(zip(of.cases, of.share, strict=True)) for of in (STOP.log_peak, STOP.log_stiffness)]
if _ROADS[0] != _ROADS[1]:
    raise ValueError(f"peak and stiffness are of the same roads, as often: {_ROADS}")


@dataclass(frozen=True)
class _Scenarios:
    """Stops, equally likely, (n,): the car ``of`` each, and what the stop brings.

    ``change`` of ln of the pads' ratio since the ramp; ``peak`` of the road over that of the ramp;
    ``stiff`` ln of the tyres' stiffness of the axles over that of the ramp, (2, n); ``scale`` of
    a_x and pitch, ``offset`` of a_x since the lead-in; ``mass`` ln of the mass over the file's.
    """

    of: Ensemble
    change: Array
    peak: Array
    stiff: Array
    scale: Array
    offset: Array
    mass: Array

    @property
    def log_pad_ratio(self) -> Array:
        """ln of the pads' ratio in the stop, over that of the vehicle file."""
        return self.of.log_pad_ratio + self.change

    def level(self, z: float) -> Array:
        """ln of the brake force over that which ``z`` and the mass of the file give [1]."""
        return np.asarray(np.log(np.maximum(1.0 - self.offset / z, 0.05)) + self.mass)


def scenarios(car: Vehicle, e: Ensemble, count: int = _SCENARIOS) -> _Scenarios:
    """``count`` stops of the cars of an ensemble, by a fixed sequence.

    Where the file says that the car is weighed, nobody has left a load unstated.
    """
    from scipy.special import ndtri

    even = dict(zip(_EVEN, spread_evenly(count, len(_EVEN)).T, strict=True))

    def uniform(name: str) -> Array:
        return even[name] if name in even else _in_any_order(count, name)

    def drawn(name: str, case: str = "", axle: str = "") -> Array:
        of: Mixture = getattr(STOP, name)
        return of.drawn(uniform(case or f"{name}{axle} case"), ndtri(uniform(name + axle)))

    of = e.take(np.arange(count) % e.size)
    log_peak, stiff = (drawn(name, "road") for name in ("log_peak", "log_stiffness"))
    other = STOP.log_peak.is_case("other road", uniform("road"))  # it has a peak of its own
    log_peak -= other * np.log(of.peak)
    stiff += 0.25 * other * (log_peak + np.log(of.peak / 0.9))
    stated = STOP.log_mass.is_case("as stated", uniform("log_mass case"))
    mass = car.mass_tolerance * ndtri(uniform("log_mass"))
    return _Scenarios(
        of=of,
        change=drawn("log_pad_ratio"),
        peak=np.exp(log_peak),
        stiff=stiff + np.stack([drawn("log_tyre", axle=f"_{axle}") for axle in AXLES]),
        scale=drawn("a_x_scale"),
        offset=drawn("a_x_offset"),
        mass=np.where(stated | (car.mass_tolerance <= WEIGHED), mass, drawn("log_mass")),
    )


def _in_any_order(count: int, name: str) -> Array:
    """Uniform numbers (count,) of a ``name``: the middles of as many steps, in its own order."""
    order = np.random.default_rng(crc32(name.encode())).permutation(count)
    return np.asarray((order + 0.5) / count)


def seen(car: Vehicle, s: _Scenarios, z: Array, odds: Array | float = 0.0) -> Shown:
    """What is seen where the zeroed deceleration demands the brake force ``z`` (k,) [1].

    ``z`` over the weight; ``odds`` (k,) ln of the front pressure over the rear one.
    """
    return shown(
        car,
        s.of,
        s.log_pad_ratio[:, None] + odds,
        (z - s.offset[:, None]) * (1.0 - s.scale[:, None]),
        z,
        peak=s.peak,
        softer=np.exp(-s.stiff)[..., None],
    )


_Z = np.array([0.06, 0.1, 0.15, 0.22, 0.32, 0.45, 0.6, 0.85])  # demanded force over weight [1]
_SHIFTS = 21  # values of (eta - 1)/z, from the least to the greatest that the scenarios show
_SLIP = np.array([-2.25, -0.75, 0.75, 2.25])  # sigmas of ln(slip/z); 2 is near a peak
_QUANTILES = (0.025, 0.5, 0.975)
_DENSE = 0.004  # (eta - 1)/z up to which its values stand evenly, beyond in equal ratios [1]
_SEEN = (0.005, 0.995)  # quantiles of what the scenarios show between which the axis reaches
_FINEST = 4e-5  # least error of a zeroed eta - 1 [1]
_FORM = 0.01  # of eta - 1, relative: what a tyre departs by is in the ensemble
_PER_Z = 6e-4  # of eta - 1 per deceleration [1]: what half a cell of the map is wide
_NEAR = 0.4  # standard deviation about a place along the slip, in those of the slip
_EMPTY = 0.1  # scenarios that any cell has of the prior: one that nobody sees has nothing else
_GROUPS = 256  # of scenarios alike in what is asked, in which the weights are added up
_CHUNKS = 32  # parts of the scenarios whose weights fit into the cache of a processor


def _quantiles(x: Array, order: Index, weights: Array) -> Array:
    """`_QUANTILES` of ``x`` (n,) with ``weights`` (n, c), linear within a group, shape (c, 3).

    ``order`` in which ``x`` rises.
    """
    size = x.size // _GROUPS
    groups = order[: size * _GROUPS].reshape(_CHUNKS, -1, size)
    edges = np.append(x[groups[..., 0]], x[groups[-1, -1, -1]])
    sums = [np.ones(size) @ weights.take(chunk, axis=0) for chunk in groups]
    below = np.cumsum(np.concatenate(sums), axis=0)
    below = np.concatenate([np.zeros_like(below[:1]), below / below[-1]])
    return np.stack([np.interp(_QUANTILES, column, edges) for column in below.T])


def pressure_odds(runs: list[RampRun]) -> Array:
    """ln of the front pressure over the rear one [1] at `_Z` (k,), as on ramps of both axles.

    0 where one pressure rules; a known valve, or logged pressures of the wheels, make them differ.
    """
    x = np.hstack(
        [np.stack([run.blocks.z, run.blocks.p_f, run.blocks.p_r])[:, run.braked] for run in runs]
    )
    z, p_f, p_r = x[:, np.argsort(x[0])]
    rows = np.stack([z, np.log(np.maximum(p_f, 1.0) / np.maximum(p_r, 1.0))])
    groups = np.array_split(rows, min(20, z.size), axis=1)
    return np.asarray(np.interp(_Z, *np.transpose([group.mean(axis=1) for group in groups])))


def maps(car: Vehicle, e: Ensemble, odds: Array | float = 0.0) -> tuple[PadMap, LevelMap]:
    """The maps of an ensemble: of the pads' ratio, and of what is known before eta is read.

    ``odds`` as of `pressure_odds`: the ratio of the maps is that of the brake forces, and holds
    them.
    """
    s = scenarios(car, e)
    at = seen(car, s, _Z, odds)
    each = list(zip(_Z, at.shift.T, at.slip.T, at.rolls.T, strict=True))
    ends = [np.quantile(np.arcsinh(x[rolls] / z / _DENSE), _SEEN) for z, x, _, rolls in each]
    axis = _DENSE * np.sinh(np.linspace(np.min(ends), np.max(ends), _SHIFTS))
    orders = [np.argsort(x) for x in (s.log_pad_ratio, s.change)]
    found = []
    for one, more in zip(each, np.broadcast_to(odds, _Z.shape), strict=True):
        cells, own = _cells(*one, axis, np.stack([s.log_pad_ratio + more, s.change]), orders)
        found.append((cells, own | _bounded("level", np.quantile(s.level(one[0]), _QUANTILES))))
    pads, before = (
        {name: np.array([row[name] for row in rows]) for name in rows[0]}
        for rows in zip(*found, strict=True)
    )
    return PadMap.of((_Z, axis, _SLIP), **pads), LevelMap.of((_Z,), **before)


def _cells(
    z: float,
    shift: Array,
    slip: Array,
    rolls: Mask,
    axis: Array,
    asked: Array,
    orders: Sequence[Index],
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Columns of the maps at ``z``, of cells over the ``axis`` and `_SLIP` and without a reading.

    ``shift``, ``slip``, ``rolls`` as of `Shown`, and ``asked`` ratio and change of the pads (2, n)
    with the ``orders`` in which they rise, of the scenarios.
    """
    some = rolls[:, None].astype(float)
    least = _EMPTY / rolls.size * some
    error = np.sqrt((_FORM * shift) ** 2 + _FINEST**2 + (_PER_Z * z) ** 2)[:, None]
    near = _gauss((shift[:, None] - axis * z) / error) / error * some
    share = near.sum(axis=0) * np.gradient(axis)
    near += least * np.max(near)
    log_slip = np.log(np.maximum(slip, 1e-4) / z)
    middle, spread = _moments(near, log_slip[None])
    mean, sigma = middle[:, 0], np.maximum(np.sqrt(spread[:, 0, 0]), 0.02)
    apart = (log_slip[:, None] - mean) / sigma
    weights = np.empty((log_slip.size, 1 + axis.size * _SLIP.size))
    weights[:, :1] = some
    more, size = least * np.max(near), log_slip.size // _CHUNKS
    for start in range(0, log_slip.size, size):
        rows = slice(start, start + size)
        for place, sigmas in enumerate(_SLIP / _NEAR, 1):
            both = _gauss(apart[rows] / _NEAR - sigmas)
            both *= near[rows]
            np.add(both, more[rows], out=weights[rows, place :: _SLIP.size])
    flat = {"log_slip": mean, "log_slip_sigma": sigma, "share": share / share.sum()}
    cells = {name: np.repeat(x[:, None], _SLIP.size, axis=1) for name, x in flat.items()}
    # over the width of a cell the pads are linear in the slip: taken out, it blurs nothing
    middle, joint = (of[1:] for of in _moments(weights, np.vstack([log_slip, asked])))
    off = (mean[:, None] + sigma[:, None] * _SLIP).ravel() - middle[:, 0]
    before: dict[str, Array] = {}
    for k, (name, x) in enumerate(zip(("ratio", "change"), asked, strict=True), 1):
        whole, *found = _quantiles(x, orders[k - 1], weights)
        slope, spread = joint[:, 0, k] / joint[:, 0, 0], np.array(found)
        left = np.sqrt(1.0 - slope * joint[:, 0, k] / joint[:, k, k])[:, None]
        within = spread[:, 1:2] + left * (spread - spread[:, 1:2]) + (slope * off)[:, None]
        cells |= _bounded(name, within.reshape(axis.size, _SLIP.size, 3))
        before |= _bounded(name, whole)
    width, most = (of["ratio_upper"] - of["ratio_lower"] for of in (cells, before))
    return cells | {"prior": np.minimum(width / most, 1.0)}, before


_LEAST = -60.0  # logarithm of a weight that nobody sees; products of smaller ones are slow


def _gauss(x: Array) -> Array:
    """``exp(-x^2/2)``, in the place of ``x``: the arrays are large."""
    x *= x
    x *= -0.5
    return np.exp(np.maximum(x, _LEAST, out=x), out=x)


def _moments(weight: Array, x: Array) -> tuple[Array, Array]:
    """Means (c, k) and covariances (c, k, k) of ``x`` (k, n) with weights (n, c)."""
    centre = x.mean(axis=1)
    apart, k = x - centre[:, None], len(x)
    squares = (apart[:, None] * apart).reshape(k * k, -1)
    sums = np.vstack([np.ones_like(apart[:1]), apart, squares]) @ weight
    mean, square = (sums[1:] / sums[0]).T[:, :k], (sums[1:] / sums[0]).T[:, k:]
    covariance = square.reshape(-1, k, k) - mean[:, :, None] * mean[:, None, :]
    return mean + centre, covariance + 1e-12 * np.eye(len(x))


def _bounded(name: str, x: Array) -> dict[str, Array]:
    return {f"{name}_lower": x[..., 0], name: x[..., 1], f"{name}_upper": x[..., 2]}
