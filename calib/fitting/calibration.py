"""The pads of a calibration, each with its sigma."""

import numpy as np

from calib.car.bias import front_share
from calib.car.vehicle import Vehicle
from calib.table.budget import Parts
from calib.table.table import Calibration, Value


def calibration_of(vehicle: Vehicle, scale: float, ratio: Value, level: Parts) -> Calibration:
    """Pads from the ``scale`` of both axles [1], the logarithm of their ``ratio``, and the parts of
    the variance of their ``level``.

    The sum of forces fixes the mean of both axles weighed by their share. The scale, which is
    their geometric mean, moves against it with the ratio by half the difference of the shares.
    """
    relative = float(np.sqrt(sum(level.values())))
    share = front_share(vehicle, ratio.value)
    half = float(np.exp(0.5 * ratio.value))
    mu_f = scale * vehicle.front.pad_friction * half
    mu_r = scale * vehicle.rear.pad_friction / half
    return Calibration(
        pad_scale=Value(scale, scale * float(np.hypot(relative, (share - 0.5) * ratio.sigma))),
        pad_log_ratio=ratio,
        pad_friction_f=Value(mu_f, mu_f * float(np.hypot(relative, (1.0 - share) * ratio.sigma))),
        pad_friction_r=Value(mu_r, mu_r * float(np.hypot(relative, share * ratio.sigma))),
    )
