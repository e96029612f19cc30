"""Judge how well a fit explains its ramps: residuals, metrics, remarks and warnings.

Residuals are those of eta and slip of each block, over their errors. A fit is refused where no draw
can transmit the forces of a ramp, or where the residuals are far above 1.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.warning import Measured, PlausibilityWarning, rule_warnings
from calib.car.balance import front_biased_up_to
from calib.car.mass import MassUsed
from calib.car.plausible import vehicle_warnings
from calib.car.vehicle import Vehicle
from calib.fitting.curves import find_peak
from calib.fitting.ensemble import Ensemble, SlipPrediction
from calib.fitting.hypotheses import LATE
from calib.fitting.posterior import Posterior, posterior
from calib.fitting.prior import Prior
from calib.fitting.regression import Regression
from calib.model.ramp import SETTINGS, RampRun
from calib.plausibility.evidence import Evidence
from calib.plausibility.rules import COAST, FIT, warnings_on
from calib.run.filters import true_intervals
from calib.run.resistance import ROLLING, Resistance
from calib.run.resistance import identify as identify_resistance
from calib.run.run import Run
from calib.table.table import Value

_DRAWS = 64  # draws whose median residual is taken; its error is far below that of a block

MOVE_ETA = (LATE, "unexplained_braking_force", "force_step")
"""Codes of warnings whose cause changes eta itself. An eta that no tyre explains refuses the fit,
unless a mistake with another code is named, which may explain the misfit."""

_LARGEST_RMS = 3.0
"""Largest root mean square of the residuals of eta on a ramp [1]. Tyres of other forms leave 0.5 to
1.4; a wheel speed that repeats its value for 0.1 s, which moves the pads' ratio by a sixth, 5."""


def explained(
    car: Vehicle,
    runs: list[RampRun],
    ratio: Value,
    priors: Sequence[Prior],
    refused: Callable[..., LogError],
    named: Sequence[PlausibilityWarning],
) -> tuple[Posterior, dict[str, float]]:
    """Return the posterior of the ramps, and figures of its residuals.

    ``runs`` include a ramp of both axles. ``ratio`` is the prior of ln of the pads' ratio,
    ``priors`` are informative priors of the car, ``named`` are warnings whose causes may explain a
    misfit. Raises ``refused`` where no draw can transmit the forces, where v contradicts the wheel
    speeds, and where no tyre explains eta, unless ``named`` has a warning other than `MOVE_ETA`.
    """
    try:
        ensemble = posterior(car, runs, ratio, priors=priors)
    except ValueError as error:
        raise refused(
            "no tyre carries the forces of the ramps",
            expected="no wheel near its limit, and mass, axle loads and radii of this car",
            do="end the ramp before ABS works or a wheel locks; look at it with `brake-cal check`",
        ) from error
    by_ramp = _ramp_residuals(car, ensemble, runs)
    worst = max(_rms(eta) for eta, _ in by_ramp)
    if worst > _LARGEST_RMS and any(run.slip is not None for run in runs):
        without_v = [replace(run, slip=None) for run in runs]
        by_wheels = posterior(car, without_v, ratio, priors=priors)
        if max(_rms(eta) for eta, _ in _ramp_residuals(car, by_wheels, without_v)) < _LARGEST_RMS:
            raise refused(
                "v contradicts the wheel speeds: no tyre explains both. With v the residual of eta "
                f"is {worst:.1f} times its error, without v at most {_LARGEST_RMS:.0f} times",
                expected="a v of the same car, in time and to scale",
                do="check clock, filter and scale of v, or leave v out of the log",
            )
    if worst > _LARGEST_RMS and all(warning.code in MOVE_ETA for warning in named):
        likely = [warning.causes[0] for warning in named]
        raise refused(
            f"no tyre explains eta: the residual is {worst:.1f} times the error of wheel speeds",
            expected=f"at most {_LARGEST_RMS:.0f} times",
            do="; or ".join([*likely, "a wheel speed that is late, or coarse"])
            + ": look at the log with `brake-cal check`",
        )
    eta, slip = (np.concatenate(x) for x in zip(*by_ramp, strict=True))
    return ensemble, {
        "residual_eta_rms_sigma": _rms(eta),
        "residual_slip_rms_sigma": _rms(slip),
        "outliers": float(np.count_nonzero(np.abs(eta) > SETTINGS.outlier)),
    }


def _ramp_residuals(
    car: Vehicle, e: Ensemble, runs: Sequence[RampRun]
) -> list[tuple[Array, Array]]:
    """Return the residuals of eta and slip on each ramp of both axles."""
    return [residuals(car, e, run) for run in runs if run.only is None]


def residuals(car: Vehicle, e: Ensemble, run: RampRun) -> tuple[Array, Array]:
    """Return the residuals of eta and slip over their errors at the braked blocks, (k,) each.

    The residuals of slip are empty without v. The errors include the error of the forces by the
    noise of z. On a rough road this error is five times that by the wheels.
    """
    regression = Regression(car, [run], groups=None)
    (ramp,) = regression.ramps
    z, z_noise = ramp.z[1:], run.noise.z / np.sqrt(run.blocks.length)  # ramp.z[0]: the lead-in
    slope = ramp.measured @ z / (z @ z)  # of eta - 1 and of slip over z, (2,)
    forces = np.repeat(np.abs(slope) * z_noise, z.size)
    errors = regression.errors["noise"], regression.errors["tyres"], forces[:, None]
    sigma = np.linalg.norm(np.hstack(errors), axis=1)
    lasting = np.hstack([regression.errors["zeros"], regression.errors["accelerometer"]])
    residual = regression.residuals(e.take(np.linspace(0, e.size - 1, _DRAWS).astype(np.int64)))
    # subtract the posterior mean of the errors that last over the run, L L' C^-1 r with L = lasting
    # and C^-1 = white' white
    residual -= residual @ regression.white.T @ regression.white @ lasting @ lasting.T
    eta, slip = np.split(np.median(residual, axis=0) / sigma, 2)
    return eta, slip[:0] if run.slip is None else slip


def _rms(x: Array) -> float:
    """Root mean square, 0 for an empty ``x``."""
    return float(np.linalg.norm(x) / np.sqrt(max(x.size, 1)))


def metrics(
    vehicle: Vehicle, runs: list[RampRun], path: SlipPrediction, prior_weight: float
) -> dict[str, float]:
    """Return the quality metrics of a fit besides those of its residuals.

    ``path`` goes up to the highest z of the ``runs``; ``prior_weight`` is that of the prior
    in the pads' ratio [1].
    """
    z_peak, eta_peak, falls = find_peak(path)
    return {
        "deceleration_max": float(path.z[-1]),
        "front_biased_up_to": min(front_biased_up_to(vehicle), 9.99),
        "eta_peak": eta_peak,
        "eta_peak_deceleration": z_peak,
        "eta_peak_is_real": float(falls),
        "pad_ratio_nominal_weight": prior_weight,
        "runs": float(len(runs)),
    }


def remarks(
    vehicle: Vehicle,
    mass: MassUsed,
    runs: list[RampRun],
    prior_support: Sequence[tuple[Prior, float]],
) -> Iterator[str]:
    """Yield sentences on decisions of the fit that the table's numbers and warnings do not show."""
    if vehicle.effects.described:
        yield f"known effects taken out of the logs: {', '.join(vehicle.effects.described)}"
    if mass.stated:
        yield f"mass in the logs: {mass}"
    for run in runs:
        b = run.blocks
        zero = float(np.mean(b.eta[run.rolling])) - 1.0
        yield f"{run.name}: eta zeroed by {100 * zero:+.3f} % (rolling radii)"
        left_out = [] if run.left_out is None else true_intervals(run.left_out)
        for first, after in left_out:
            start, end = b.end[first] - b.length, b.end[after - 1]
            yield f"{run.name}: left out from {start:.2f} to {end:.2f} s: a bump, another force"
    for prior, p in prior_support:
        yield f"what {prior.name} says holds for this car with {100.0 * p:.0f} %, by its ramps"


def warnings_of(
    filed: Vehicle, ramps: Sequence[Run], coasts: Sequence[Run], identified: Resistance
) -> Iterator[PlausibilityWarning]:
    """Yield the warnings of vehicle file and logs, except those of the pads, which need the fit.

    ``filed`` is the vehicle of the file. ``identified`` is the resistance of all logs, which is
    judged unless the file gives one. A ramp is judged with the resistance of the coasts, if any.
    """
    for warning in vehicle_warnings(filed):
        if not warning.code.startswith("pad_friction"):
            yield warning
    car = ramps[0].car
    (rolling_resistance, _), (_, coefficient) = ROLLING, identified.mean
    if rolling_resistance not in car.effects:
        yield from rule_warnings(car.name, [Measured("rolling_resistance", coefficient)])
    of_coasts = identified
    if coasts:
        of_coasts = identify_resistance(car, ((x.blocks, x.noise.z) for x in coasts))
    straight_runs = {FIT: coasts, COAST: ()}  # other runs of a straight road, to compare with
    runs = [(run, FIT, of_coasts) for run in ramps] + [(run, COAST, identified) for run in coasts]
    for run, purpose, resistance in runs:
        sensor, response = run.accelerometer(resistance), run.response(identified.effects)
        yield from warnings_on(Evidence(run, sensor, response, straight_runs[purpose]), purpose)
