"""What an ensemble leaves of the eta and the slip of a ramp, block by block, over their noise."""

import numpy as np

from calib.base.arrays import Array, Index
from calib.base.names import G
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import Ensemble, brake_share
from calib.fitting.ridge import shown
from calib.model.ramp import RampRun, sigma_eta, sigma_slip
from calib.model.settings import SETTINGS

_SOME = 64  # draws whose median is taken: it is known far better than a block


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
    rise, slip = (np.median(x, axis=0) for x in shown(car, some, b.z[use], *forces)[:2])
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
