r"""The maps of a table: what the pads' ratio is, given what an ECU sees.

Every scenario of `calib.fitting.stops` says what the sensors would see at a deceleration. In a cell
of the map those count that would see about the cell, by the noise that a reading has at least and
by what a tyre departs from its form; their ratio of the pads gives median and bounds of the cell.
All that the ramps left open, and all that a stop may bring, is inside: a posterior with two peaks,
a softer road or weak rear pads, has bounds that hold both.
"""

import numpy as np

from calib.base.arrays import Array
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import PRIORS, Ensemble
from calib.fitting.stops import scenarios, seen
from calib.table.maps import LevelMap, PadMap

Z = np.array([0.06, 0.1, 0.15, 0.2, 0.27, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85])
"""Decelerations of the maps [1]."""

SHIFT = 0.004 * np.sinh(np.linspace(-1.0, 4.6, 27))
"""(eta - 1)/z of the map [1]: wet tile has 0.06 to 0.12."""

QUANTILES = (0.025, 0.5, 0.975)

_FINEST = 4e-5  # least error of a zeroed eta - 1 [1]
_PER_Z = 6e-4  # of eta - 1 per deceleration [1]: what half a cell of the map is wide
_EMPTY = 1.0  # scenarios that any cell has of the prior: one that nobody sees has nothing else
_SHARP = 0.02  # error of ln(slip/z) that is left where the slip is known [1]
_GROUPS = 320  # of scenarios alike in what is asked, in which the weights are added up


class _Sorted:
    """Weighted quantiles of ``values`` (n,)."""

    def __init__(self, values: Array) -> None:
        count = values.size // _GROUPS * _GROUPS
        self.order = np.argsort(values)[:count].reshape(_GROUPS, -1)
        inner = values[self.order]
        self.edges = np.append(inner[:, 0], inner[-1, -1])

    def quantiles(self, weights: Array) -> Array:
        """Of `QUANTILES` with ``weights`` (n, c), linear within a group, shape (c, 3)."""
        weight = weights[self.order].sum(axis=1)
        below = np.cumsum(weight, axis=0)
        below = np.concatenate([np.zeros_like(below[:1]), below / below[-1]])
        return np.stack([np.interp(QUANTILES, column, self.edges) for column in below.T])


def maps(car: Vehicle, e: Ensemble) -> tuple[PadMap, LevelMap]:
    """The maps of an ensemble: of the pads' ratio, and of what is known before eta is read."""
    s = scenarios(car, e)
    asked = {"ratio": s.log_pad_ratio, "change": s.change}
    quantiles = {name: _Sorted(values) for name, values in asked.items()}
    rows: list[dict[str, Array]] = []
    before: list[dict[str, Array]] = []
    for z in Z:
        at = seen(car, s, float(z))
        rolls = at.rolls[:, None].astype(float)
        one = {"level": np.quantile(at.level, QUANTILES)}
        one |= {name: of.quantiles(rolls)[0] for name, of in quantiles.items()}
        error = np.sqrt(
            (PRIORS["form_error_eta"][0] * at.shift) ** 2 + _FINEST**2 + (_PER_Z * z) ** 2
        )[:, None]
        weight = np.exp(-0.5 * ((at.shift[:, None] - SHIFT * z) / error) ** 2) / error * rolls
        weight += _EMPTY * float(np.max(weight)) / weight.shape[0] * rolls
        log_slip = np.log(np.maximum(at.slip, 1e-4) / z)
        slip, variance = _moments(weight, log_slip, log_slip)
        row = {"log_slip": slip, "log_slip_sigma": np.sqrt(variance)}
        for name, values in asked.items():
            found = quantiles[name].quantiles(weight)
            _, own = _moments(weight, values, values)
            _, common = _moments(weight, values, log_slip)
            slope = common / (variance + _SHARP**2)
            row |= _bounded(name, found)
            row[f"{name}_per_slip"] = slope
            row[f"{name}_left"] = np.clip(1.0 - slope * common / own, 0.0, 1.0)
        width = (row["ratio_upper"] - row["ratio_lower"]) / np.ptp(one["ratio"])
        row["prior"] = np.minimum(width, 1.0)
        rows.append(row)
        before.append({k: v for name, q in one.items() for k, v in _bounded(name, q).items()})
    return (
        PadMap.of((Z, SHIFT), **{name: np.stack([row[name] for row in rows]) for name in rows[0]}),
        LevelMap.of((Z,), **{name: np.array([row[name] for row in before]) for name in before[0]}),
    )


def _moments(weight: Array, x: Array, y: Array) -> tuple[Array, Array]:
    """Mean of ``x`` (n,) and its covariance with ``y`` (n,), with weights (n, c), (c,) each."""
    total = weight.sum(axis=0)
    mean_x, mean_y = x @ weight / total, y @ weight / total
    return mean_x, (x * y) @ weight / total - mean_x * mean_y


def _bounded(name: str, x: Array) -> dict[str, Array]:
    return {f"{name}_lower": x[..., 0], name: x[..., 1], f"{name}_upper": x[..., 2]}
