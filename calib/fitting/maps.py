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
from calib.fitting.stops import Scenarios, scenarios, seen
from calib.table.maps import LevelMap, PadMap, SpeedMap

Z = np.array([0.06, 0.1, 0.15, 0.2, 0.27, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85])
"""Decelerations of the maps [1]."""

SHIFT = np.concatenate([[-0.004], np.linspace(-0.002, 0.02, 23), [0.025, 0.03, 0.04, 0.05]])
"""(eta - 1)/z of the map without a speed [1]."""

SLIP_RATIO = np.linspace(-0.25, 0.9, 24)
LOG_SLIP = np.linspace(np.log(0.012), np.log(0.25), 12)
"""(eta - 1)/slip, and ln(slip/z), of the map with a speed [1]."""

QUANTILES = (0.025, 0.5, 0.975)

_FINEST = 4e-5  # least error of a zeroed eta - 1 [1]
_PER_Z = 6e-4  # of eta - 1 per deceleration [1]: what half a cell of the map is wide
_RATIO = 0.01  # least error of (eta - 1)/slip [1]
_LOG_SLIP = 0.06  # of ln(slip/z) [1], half a cell
_EMPTY = 1.0  # scenarios that any cell has of the prior: one that nobody sees has nothing else


_GROUPS = 320  # of scenarios alike in what is asked, in which the weights are added up


class _Sorted:
    """Quantiles of ``values`` (n,) with weights that are products of two: (n, a) and (n, b)."""

    def __init__(self, values: Array) -> None:
        count = values.size // _GROUPS * _GROUPS
        self.order = np.argsort(values)[:count].reshape(_GROUPS, -1)
        inner = values[self.order]
        self.edges = np.append(inner[:, 0], inner[-1, -1])

    def quantiles(self, first: Array, second: Array) -> Array:
        """Of `QUANTILES`, linear within a group, shape (a, b, 3)."""
        x, y = first[self.order], second[self.order]
        weight = x.transpose(0, 2, 1) @ y
        weight += _EMPTY / _GROUPS * float(first.max() * second.max())
        below = np.cumsum(weight, axis=0)
        below = np.concatenate([np.zeros_like(below[:1]), below / below[-1]])
        out = np.empty((*weight.shape[1:], len(QUANTILES)))
        for cell in np.ndindex(weight.shape[1:]):
            out[cell] = np.interp(QUANTILES, below[:, *cell], self.edges)
        return out


def _near(x: Array, sigma: Array, grid: Array) -> Array:
    """How likely each ``x`` (n,) reads as each value of the ``grid`` (c,), (n, c)."""
    return np.asarray(np.exp(-0.5 * ((x[:, None] - grid) / sigma[:, None]) ** 2) / sigma[:, None])


def maps(car: Vehicle, e: Ensemble) -> tuple[PadMap, SpeedMap, LevelMap]:
    """The maps of an ensemble: without a speed, with one, and of the level."""
    s = scenarios(car, e)
    ratios, changes, one = _Sorted(s.log_pad_ratio), _Sorted(s.change), np.ones((s.change.size, 1))
    shift = np.empty((2, Z.size, SHIFT.size, 3))
    speed = np.empty((2, Z.size, SLIP_RATIO.size, LOG_SLIP.size, 3))
    before = np.empty((3, Z.size, 3))
    for i, z in enumerate(Z):
        at = seen(car, s, float(z))
        rolls = at.rolls[:, None].astype(float)
        error = np.sqrt((PRIORS["form_error_eta"][0] * at.shift) ** 2 + _FINEST**2 + (_PER_Z * z) ** 2)
        by_shift = _near(at.shift, error, SHIFT * z) * rolls
        slip = np.maximum(at.slip, 1e-4)
        ratio = at.shift / slip
        error = np.sqrt((PRIORS["form_error_eta"][0] * ratio) ** 2 + (_FINEST / slip) ** 2 + _RATIO**2)
        by_ratio = _near(ratio, error, SLIP_RATIO) * rolls
        by_slip = _near(np.log(slip / z), np.full_like(slip, _LOG_SLIP), LOG_SLIP)
        for k, of in enumerate((ratios, changes)):
            shift[k, i] = of.quantiles(by_shift, one)[:, 0]
            speed[k, i] = of.quantiles(by_ratio, by_slip)
        before[0, i] = np.quantile(at.level, QUANTILES)
        before[1, i], before[2, i] = (of.quantiles(rolls, one)[0, 0] for of in (ratios, changes))
    widest = np.ptp(before[1], axis=-1)
    return (
        PadMap.of((Z, SHIFT), **_columns(shift, widest[:, None])),
        SpeedMap.of((Z, SLIP_RATIO, LOG_SLIP), **_columns(speed, widest[:, None, None])),
        LevelMap.of(
            (Z,),
            **_bounded("level", before[0]),
            **_bounded("ratio", before[1]),
            **_bounded("change", before[2]),
        ),
    )


def _bounded(name: str, x: Array) -> dict[str, Array]:
    return {f"{name}_lower": x[..., 0], name: x[..., 1], f"{name}_upper": x[..., 2]}


def _columns(x: Array, widest: Array) -> dict[str, Array]:
    prior = np.minimum((x[0, ..., 2] - x[0, ..., 0]) / widest, 1.0)
    return {**_bounded("ratio", x[0]), **_bounded("change", x[1]), "prior": prior}
