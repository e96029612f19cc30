"""The pads of a calibration, each with its sigma."""

import numpy as np

from calib.fitting.identify import Identified
from calib.fitting.ramp import RampRun
from calib.fitting.resistance import Resistance
from calib.physics.balance import brake_forces
from calib.physics.vehicle import Vehicle
from calib.table.table import Calibration, Value


def calibration(
    vehicle: Vehicle, found: Identified, runs: list[RampRun], known: Resistance
) -> Calibration:
    """Pad level with sigma from noise, drag and mass; pad ratio from the posterior.

    The sum of forces fixes the mean of both axles weighed by their share. The scale, which is
    their geometric mean, moves against it with the ratio by half the difference of the shares.
    """
    scale = float(np.mean(found.pad_scale))
    sigma_z = np.mean([_sigma_level(vehicle, run, known) for run in runs])
    between = float(np.std(found.pad_scale)) / np.sqrt(len(runs))
    relative = float(np.sqrt(sigma_z**2 + between**2 + vehicle.mass_tolerance**2))
    rho = found.posterior.value("log_pad_ratio")
    sigma_rho = found.posterior.sigma("log_pad_ratio")
    B_f, B_r = brake_forces(vehicle, np.ones(()), np.ones(()), rho)
    share = float(B_f / (B_f + B_r))
    half = float(np.exp(0.5 * rho))
    mu_f = scale * vehicle.front.pad_friction * half
    mu_r = scale * vehicle.rear.pad_friction / half
    return Calibration(
        pad_scale=Value(scale, scale * float(np.hypot(relative, (share - 0.5) * sigma_rho))),
        pad_log_ratio=Value(rho, sigma_rho),
        pad_friction_f=Value(mu_f, mu_f * float(np.hypot(relative, (1.0 - share) * sigma_rho))),
        pad_friction_r=Value(mu_r, mu_r * float(np.hypot(relative, share * sigma_rho))),
    )


def _sigma_level(vehicle: Vehicle, run: RampRun, known: Resistance) -> float:
    """Relative sigma of the pad scale of a run from the noise of z and the resistance."""
    braked = run.use & ~run.blocks.lead_in
    z = run.blocks.z[braked]
    noise = run.noise.z / np.sqrt(run.blocks.length * float(z @ z))
    resist = known.sigma_z(vehicle, run.blocks.speed[braked])
    return float(np.hypot(noise, (resist @ z) / (z @ z)))
