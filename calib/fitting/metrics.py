"""How good a fit is, in numbers."""

import numpy as np

from calib.car.bias import front_biased_up_to
from calib.car.vehicle import Vehicle
from calib.fitting.identify import Identified
from calib.fitting.path import Peak
from calib.model.ramp import RampRun
from calib.model.settings import SETTINGS


def metrics(
    vehicle: Vehicle, found: Identified, runs: list[RampRun], peak: Peak, z_max: float
) -> dict[str, float]:
    """Quality metrics of the fit, each a plain number."""
    eta_rms = float(np.sqrt(np.mean(np.concatenate([e for e, _ in found.residuals]) ** 2)))
    slip = np.concatenate([s for _, s in found.residuals])
    return {
        "deceleration_max": z_max,
        "front_biased_up_to": min(front_biased_up_to(vehicle), 9.99),
        "eta_peak": peak.eta,
        "eta_peak_deceleration": peak.z,
        "eta_peak_is_real": float(peak.real),
        "residual_eta_rms_sigma": eta_rms,
        "residual_slip_rms_sigma": float(np.sqrt(np.mean(slip**2))) if slip.size else 0.0,
        "outliers": float(sum(len(outliers(run, found, i)) for i, run in enumerate(runs))),
        "pad_ratio_nominal_weight": found.nominal_weight,
        "runs": float(len(runs)),
    }


def outliers(run: RampRun, found: Identified, index: int) -> list[float]:
    """Times [s] of the blocks of a run whose eta lies past ``outlier`` sigma of `FitSettings`."""
    residual = found.residuals[index][0]
    return [float(t) for t in run.blocks.end[run.use][np.abs(residual) > SETTINGS.outlier]]
