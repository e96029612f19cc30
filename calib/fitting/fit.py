"""From ramps to a table: the whole of `brake-cal fit` in one place.

logs --> signals --> resistance (coasting) --> tyre and pads --> curves --> table
"""

from dataclasses import asdict

import numpy as np
from numpy.typing import NDArray

from calib import __version__
from calib.checks.check import problems_for
from calib.checks.gates import bitten, eta_rise, refuse_twice, require_same_wheels
from calib.errors import LogError
from calib.fitting import curves, identify, resistance
from calib.fitting.identify import Identified, RampRun
from calib.fitting.known_effects import remove_known_effects
from calib.fitting.resistance import RESISTANCE, Resistance
from calib.logs.log import Log
from calib.physics.balance import brake_forces
from calib.physics.braking import BITE
from calib.physics.forces import front_biased_up_to
from calib.physics.vehicle import Vehicle
from calib.signals.axle_signals import signals
from calib.signals.blocks import Blocks, blocks
from calib.signals.noise import SensorNoise, sensor_noise
from calib.table.table import (
    Calibration,
    LogReference,
    Provenance,
    Table,
    TyrePosterior,
    Value,
)

Array = NDArray[np.float64]

OUTLIER = 4.0
"""Residuals past this many sigma are named."""


def fit(vehicle: Vehicle, logs: list[Log]) -> Table:
    """Fit one table from ramped brakings.

    Parameters
    ----------
    vehicle : names the table. The effects that it knows are taken out of the logs first, see
        `calib.fitting.known_effects`.
    logs : one ramp or more; logs without braking serve as coast logs.

    Raises LogError when no log is a ramp that will do, with the reason and what to drive instead;
    ModelError when an effect cannot be taken out of a log.

    >>> import calib
    >>> logs = calib.sample_logs() / "simulation_study"
    >>> car = calib.read_vehicle(logs / "vehicle.toml")
    >>> table = calib.fit(car, [calib.read_log(logs / "ramp_noisy.parquet")])
    >>> pads = table.calibration
    >>> [low < 0.4 < high for low, high in (pads.pad_friction_f.ci95, pads.pad_friction_r.ci95)]
    [True, True]

    0.4 is what the simulation had [1].
    """
    notes = {(log.name, log.digest): log.notes for log in logs}
    corrected = [remove_known_effects(vehicle, log) for log in logs]
    car = corrected[0].vehicle if corrected else vehicle
    ramps, coasts = sort_logs(car, [run.log for run in corrected])
    known = resistance.identify(car, [(b, noise.z) for _, b, noise in ramps + coasts])
    runs = [identify.prepare(car, log.name, b, noise, known.effects) for log, b, noise in ramps]
    found, runs = identify.identify(car, runs)
    z_max = float(max(np.max(run.blocks.z[run.use]) for run in runs))
    _require_tyre(car, found, z_max, ramps)
    peak = curves.find_peak(car, found, z_max)
    z_end = curves.readable_up_to(car, found, z_max)
    if z_end <= 0.0:
        raise LogError(
            "eta does not rise under braking, so there is no curve over it: the rear axle brakes "
            "as hard for its load as the front axle, or harder",
            where=", ".join(log.source for log, _, _ in ramps),
            expected=f"a front-biased car; by its file {car.name} is so up to "
            f"{front_biased_up_to(car):.2f} g",
            do="check areas and radii of the brakes in the vehicle file",
        )
    quality = figures(car, found, runs, peak, z_max)
    return Table(
        name=vehicle.name,
        vehicle=vehicle,
        difference=curves.difference_curve(car, found, runs, z_end),
        paper=curves.paper_table(car, found, runs, z_end),
        tyre=curves.tyre_curve(car, found, runs, z_max),
        posterior=TyrePosterior(
            names=identify.PARAMETERS,
            mean=tuple(float(v) for v in found.mean),
            covariance=tuple(tuple(float(v) for v in row) for row in found.covariance),
        ),
        calibration=calibration(car, found, runs, known),
        effects=known.effects.only(*RESISTANCE),
        noise=asdict(worst_noise([run.noise for run in runs])),
        quality=quality,
        remarks=(
            *taken_out(vehicle),
            *remarks(car, found, runs, known, peak, len(coasts)),
        ),
        provenance=Provenance(
            logs=tuple(
                LogReference(log.name, log.digest, role, notes[log.name, log.digest])
                for role, group in (("ramp", ramps), ("coast", coasts))
                for log, _, _ in group
            ),
            settings=settings(),
            program=f"brake-cal {__version__}",
        ),
    )


Prepared = tuple[Log, Blocks, SensorNoise]


def sort_logs(vehicle: Vehicle, logs: list[Log]) -> tuple[list[Prepared], list[Prepared]]:
    """Ramps and coast logs, each with blocks and noise, in the order of their digests.

    The order of the command line must not change a bit of the table. Raises LogError for a log
    that will not do, that is not of this vehicle, or that is there twice.
    """
    refuse_twice(logs)
    ramps: list[Prepared] = []
    coasts: list[Prepared] = []
    for log in sorted(logs, key=lambda item: item.digest):
        s = signals(log, vehicle)
        coasting = float(np.max(np.maximum(s.p_f, s.p_r))) < BITE
        problems = problems_for(log, "diagnose" if coasting else "fit")
        if problems:
            raise LogError(
                f"this {'coast' if coasting else 'run'} will not do for a fit: "
                + "; ".join(problems),
                where=log.source,
                do="see `brake-cal check`",
            )
        require_same_wheels(vehicle, log, s)
        b = blocks(s)
        if not coasting:
            _require_front_bias(vehicle, log, b)
        (coasts if coasting else ramps).append((log, b, sensor_noise(log, b)))
    if not ramps:
        raise LogError(
            "none of the logs holds a braking",
            where=", ".join(log.source for log in logs),
            expected="at least one ramp: 1 s unbraked, then pressure rising over 5 s or more",
        )
    return ramps, coasts


def _require_tyre(vehicle: Vehicle, found: Identified, z_max: float, ramps: list[Prepared]) -> None:
    """Refuse ramps whose noise bends the compliance back: no tyre has less slip at more force."""
    top = curves.path(vehicle, found.mean, np.asarray([z_max]))
    force = np.linspace(0.0, 1.1 * float(max(top.F_f[0], top.F_r[0])), 100)
    if np.any(found.tyre.slope(force, 1.0) <= 0.0):
        raise LogError(
            "no tyre curve fits: slip would fall while force grows",
            where=", ".join(log.source for log, _, _ in ramps),
            expected="wheel speeds fine and even enough to show a slip of 0.1 %",
            do="look at the wheel speeds with `brake-cal check`, or add a second ramp",
        )


def _require_front_bias(vehicle: Vehicle, log: Log, b: Blocks) -> None:
    """Refuse a ramp on which eta falls where a front-biased car makes it rise."""
    biased = (b.z > 0.1) & (b.z < 0.8 * front_biased_up_to(vehicle))
    rise, error = eta_rise(b, biased & (b.end > bitten(b)))
    if rise < -4.0 * error:
        raise LogError(
            f"the front wheels slip less than the rear while braking: eta {100 * rise:+.2f} %",
            where=log.source,
            expected=f"a rise: {vehicle.name} is front-biased there",
            do="are the axles swapped? put them right in a channel map",
        )


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
    rho, sigma_rho = float(found.mean[5]), float(np.sqrt(found.covariance[5, 5]))
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


def worst_noise(noises: list[SensorNoise]) -> SensorNoise:
    """The largest of each: an estimator must not promise more than the worst run."""
    return SensorNoise(**{key: max(asdict(n)[key] for n in noises) for key in asdict(noises[0])})


def figures(
    vehicle: Vehicle, found: Identified, runs: list[RampRun], peak: curves.Peak, z_max: float
) -> dict[str, float]:
    """Quality figures of the fit, each a plain number."""
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
    """Times [s] of the blocks of a run whose eta lies past ``OUTLIER`` sigma."""
    residual = found.residuals[index][0]
    return [float(t) for t in run.blocks.end[run.use][np.abs(residual) > OUTLIER]]


def remarks(
    vehicle: Vehicle,
    found: Identified,
    runs: list[RampRun],
    known: Resistance,
    peak: curves.Peak,
    coasts: int,
) -> tuple[str, ...]:
    """What the user must know of this table, in words."""
    said = []
    for i, (run, zero) in enumerate(zip(runs, found.eta_zero, strict=True)):
        said.append(f"{run.name}: eta zeroed by {100 * zero:+.3f} % (rolling radii)")
        times = outliers(run, found, i)
        if times:
            listed = ", ".join(f"{t:.2f}" for t in times[:5])
            said.append(f"{run.name}: {len(times)} outlying blocks of eta, at {listed} s")
    if not known.known and not coasts:
        said.append(
            "drag and rolling resistance share one lead-in: their sum is measured, their parts "
            "are usual values; add a coast log, or give them in the vehicle file"
        )
    if all(run.blocks.v is None for run in runs):
        said.append(
            "no reference speed: slip stiffness and pad ratio cannot be told apart, the ratio "
            "rests on the vehicle file"
        )
    if peak.real:
        said.append(
            f"eta peaks at {peak.z:.2f} g: f1, f2 of eta end before it; beyond, use the tyre curve"
        )
    rho, sigma = float(found.mean[5]), float(np.sqrt(found.covariance[5, 5]))
    if found.nominal_weight < 0.5:
        low, high = np.exp(rho - 1.96 * sigma), np.exp(rho + 1.96 * sigma)
        said.append(
            f"the pads were not in the ratio of the vehicle file: front/rear {np.exp(rho):.2f} "
            f"times nominal, 95 % {low:.2f} to {high:.2f}"
        )
    return tuple(said)


def taken_out(vehicle: Vehicle) -> tuple[str, ...]:
    """What was known of the car and is not in the table's pads."""
    names = vehicle.effects.described
    return (f"known effects taken out of the logs: {', '.join(names)}",) if names else ()


def settings() -> dict[str, float]:
    """The constants the result rests on."""
    from calib.signals.blocks import BLOCK

    return {
        "block": BLOCK,
        "bite_pressure": BITE,
        "model_error": identify.MODEL_ERROR,
        "nominal_odds": identify.NOMINAL_ODDS,
    }
