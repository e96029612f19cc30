"""What an ensemble leaves of the eta and the slip of a ramp, block by block, over their noise.

A ramp that no draw carries, or that all leave far more of than the sensors err by, makes no table.
"""

from collections.abc import Sequence

import numpy as np

from calib.base.arrays import Array, Index
from calib.base.errors import LogError
from calib.base.names import G
from calib.base.warning import PlausibilityWarning
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import Ensemble, brake_share, shown
from calib.fitting.known import Known
from calib.fitting.posterior import Posterior, posterior
from calib.model.ramp import RampRun, sigma_eta, sigma_slip
from calib.model.settings import SETTINGS
from calib.table.table import Value

_SOME = 64  # draws whose median is taken: it is known far better than a block

_MOST = 3.0
"""Root mean square of the residuals of eta past which a ramp is not explained: foreign tyres leave
0.7 to 1.5, wheel speeds of 20 Hz 2, one that is held for 0.1 s, and moves the ratio of the pads by
a sixth, 5."""

Residuals = list[tuple[Array, Array]]
"""Of eta and of slip of each run, see `residuals`."""


def explained(
    car: Vehicle,
    runs: list[RampRun],
    ratio: Value,
    sources: str,
    warnings: tuple[PlausibilityWarning, ...],
    known: Sequence[Known],
) -> tuple[Posterior, Residuals]:
    """The ensemble of the ramps, ``ratio`` known of the pads before, and what it leaves of them.

    LogError, with the ``sources`` of the ramps, where it does not explain them.
    """
    lines = tuple(map(str, warnings))
    try:
        found = posterior(car, runs, ratio, known=known)
    except ValueError as error:
        raise LogError(
            "no tyre carries the forces of the ramps",
            where=sources,
            expected="no wheel near its limit, and mass, axle loads and radii of this car",
            do="end the ramp before ABS works or a wheel locks; look at it with `brake-cal check`",
            lines=lines,
        ) from error
    left = [residuals(car, found, run) for run in runs]
    worst = max(float(np.sqrt(np.mean(eta**2))) for eta, _ in left if eta.size)
    if worst > _MOST:
        raise LogError(
            f"no tyre explains eta: it is left {worst:.1f} times what the wheel speeds err by",
            where=sources,
            expected=f"up to {_MOST:.0f} times",
            do="look at the wheel speeds with `brake-cal check`: one may be late, or coarse",
            lines=lines,
        )
    return found, left


def residuals(car: Vehicle, e: Ensemble, run: RampRun) -> tuple[Array, Array]:
    """Of eta and of slip, over their sigma, over the blocks used (k,); no slip without v.

    Both are zeroed on the lead-in. Of a ramp with one axle only nothing: its forces are another's.
    """
    if run.only is not None:
        return np.empty(0), np.empty(0)
    some = e.take(np.linspace(0, e.size - 1, _SOME).astype(np.int64))
    b, use = run.blocks, np.flatnonzero(run.use)
    pressures = [np.maximum(p[use], 1.0) for p in (b.p_f, b.p_r)]
    share = brake_share(car, some.log_pad_ratio[:, None], np.log(pressures[0] / pressures[1]))
    forces = (
        (part * run.brake_sum[use] + moment[use]) / car.weight
        for part, moment in ((share, run.moment_f), (1.0 - share, run.moment_r))
    )
    of = shown(car, some, b.z[use], *forces)
    rise, slip = (np.median(x, axis=0) for x in (of.rise, of.slip))
    first = np.isin(use, run.rolling)
    measured = b.eta[use] / np.mean(b.eta[run.rolling]) - 1.0
    of_eta = (measured - rise + np.mean(rise[first])) / _at(
        sigma_eta(run, run.since_rolling(b.eta)), use
    )
    if run.slip is None:
        return of_eta, np.empty(0)
    speed = np.maximum(b.speed[use], SETTINGS.min_speed)
    slip = slip + G * b.z[use] * np.mean(some.v_late) / speed
    left = run.slip[use] - np.mean(run.slip[run.rolling]) - slip + np.mean(slip[first])
    return of_eta, left / _at(sigma_slip(run, run.since_rolling(run.slip)), use)


def _at(sigma: Array, use: Index) -> Array:
    return np.asarray(sigma[use])
