"""Mean and covariance of an ensemble in the parameters of one tyre that is a cubic.

    slip = c F (1 + b2 F + b3 F^2)        the best such curve of every draw, up to a force

Readers of a table that know that tyre go on: the figures of a ramp, the mean of cars, gauge studies
and files for calibration tools. Estimates do not: they have the maps.
"""

import numpy as np

from calib.base.arrays import Array
from calib.car.tyre_forms import inverse_forms
from calib.fitting.ensemble import Ensemble
from calib.model.parameters import RampParameters
from calib.table.table import TyrePosterior


def as_cubic(e: Ensemble, greatest: float) -> Array:
    """`RampParameters` of the draws, (8, n); ``greatest`` force over load of the ramp [1]."""
    force = np.linspace(0.1, 1.0, 10) * greatest
    use = force / e.peak[:, None]
    x = np.einsum("nkf,nf->nk", inverse_forms(use), e.forms) / use
    bend = np.linalg.lstsq(np.column_stack([force, force**2]), (x - 1.0).T, rcond=None)[0]
    of_draws = RampParameters(
        log_compliance=0.5 * np.log(e.compliance_f * e.compliance_r),
        curvature_2=bend[0],
        curvature_3=bend[1],
        load_exponent=e.load_exponent,
        clock_offset=e.v_late,
        log_pad_ratio=e.log_pad_ratio,
        log_tyre_ratio=np.log(e.compliance_f / e.compliance_r),
        radius_load=e.radius_load,
    )
    return np.stack(of_draws)


def tyre_posterior(drawn: Array) -> TyrePosterior:
    """Mean and covariance of ``drawn`` (8, n)."""
    mean, covariance = np.mean(drawn, axis=1).tolist(), np.cov(drawn, bias=True).tolist()
    return TyrePosterior(RampParameters._fields, tuple(mean), tuple(map(tuple, covariance)))
