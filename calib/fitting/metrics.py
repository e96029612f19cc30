"""How good a fit is, in numbers."""

import numpy as np

from calib.base.arrays import Array
from calib.car.bias import front_biased_up_to
from calib.car.vehicle import Vehicle
from calib.fitting.curves import Peak
from calib.fitting.regression import told
from calib.fitting.residuals import Residuals
from calib.model.ramp import RampRun
from calib.model.settings import SETTINGS


def metrics(
    vehicle: Vehicle,
    runs: list[RampRun],
    left: Residuals,
    peak: Peak,
    z_max: float,
    nominal_weight: float,
) -> dict[str, float]:
    """Quality metrics of the fit, each a plain number.

    ``left`` residuals of the ``runs``; ``nominal_weight`` of what was known of the pads' ratio
    before the ramps in what is known of it now [1].
    """
    eta, slip = (np.concatenate(x) for x in zip(*left, strict=True))
    return {
        "deceleration_max": z_max,
        "front_biased_up_to": min(front_biased_up_to(vehicle), 9.99),
        "eta_peak": peak.eta,
        "eta_peak_deceleration": peak.z,
        "eta_peak_is_real": float(peak.real),
        "residual_eta_rms_sigma": float(np.sqrt(np.mean(eta**2))),
        "residual_slip_rms_sigma": float(np.sqrt(np.mean(slip**2))) if slip.size else 0.0,
        "outliers": float(
            sum(len(outliers(run, of)) for run, (of, _) in zip(runs, left, strict=True))
        ),
        "pad_ratio_nominal_weight": nominal_weight,
        "runs": float(len(runs)),
    }


def outliers(run: RampRun, left: Array) -> list[float]:
    """Times [s] of the blocks of a run whose eta lies past ``outlier`` sigma of `FitSettings`."""
    if not left.size:
        return []
    return [float(t) for t in run.blocks.end[told(run)][np.abs(left) > SETTINGS.outlier]]
