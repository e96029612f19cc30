"""How well the ramps are explained, and what a user must know of that.

Residuals are what an ensemble leaves of eta and slip of a ramp, block by block, over their noise. A
ramp that no draw carries, or that all leave far more of than the sensors err by, makes no table.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.warning import Measured, PlausibilityWarning, judged
from calib.car.balance import front_biased_up_to
from calib.car.figures import plausible
from calib.car.vehicle import MassUsed, Vehicle
from calib.fitting.curves import find_peak
from calib.fitting.ensemble import Ensemble, Shown
from calib.fitting.known import Known
from calib.fitting.mistakes import LATE
from calib.fitting.posterior import Posterior, posterior
from calib.fitting.regression import Regression
from calib.model.ramp import SETTINGS, RampRun
from calib.plausibility.evidence import Evidence
from calib.plausibility.rules import COAST, FIT, warnings_on
from calib.run.filters import runs as runs_of
from calib.run.resistance import ROLLING, Resistance
from calib.run.resistance import identify as identify_resistance
from calib.run.run import Run
from calib.table.table import Value

_SOME = 64  # draws whose median is taken: it is known far better than a block

MOVE_ETA = (LATE, "unexplained_braking_force", "force_step")
"""What is likely where no tyre explains eta, and what no table comes of."""

_MOST = 3.0
"""Root mean square of the residuals of eta past which a ramp is not explained: foreign tyres leave
0.5 to 1.4, a wheel speed that is held for 0.1 s, and moves the ratio of the pads by a sixth, 5."""


def explained(
    car: Vehicle,
    runs: list[RampRun],
    ratio: Value,
    known: Sequence[Known],
    refused: Callable[..., LogError],
    named: Sequence[PlausibilityWarning],
) -> tuple[Posterior, dict[str, float]]:
    """The ensemble of the ramps, ``ratio`` known of the pads before, and figures of what it leaves.

    What ``refused`` makes of the reason is raised where nothing explains them; a misfit is
    excused where its cause is ``named``, and is nothing that moves eta.
    """
    try:
        found = posterior(car, runs, ratio, known=known)
    except ValueError as error:
        raise refused(
            "no tyre carries the forces of the ramps",
            expected="no wheel near its limit, and mass, axle loads and radii of this car",
            do="end the ramp before ABS works or a wheel locks; look at it with `brake-cal check`",
        ) from error
    left = _left(car, found, runs)
    worst = max(_rms(eta) for eta, _ in left)
    if worst > _MOST and any(run.slip is not None for run in runs):
        alone = [replace(run, slip=None) for run in runs]
        others = _left(car, posterior(car, alone, ratio, known=known), alone)
        if max(_rms(eta) for eta, _ in others) < _MOST:
            raise refused(
                f"v contradicts the wheel speeds: no tyre explains both, eta is left {worst:.1f} "
                "times what they err by, and without v it is explained",
                expected="a v of the same car, in time and to scale",
                do="check clock, filter and scale of v, or leave v out of the log",
            )
    if worst > _MOST and all(one.code in MOVE_ETA for one in named):
        likely = [one.causes[0] for one in named if one.code in MOVE_ETA]
        raise refused(
            f"no tyre explains eta: it is left {worst:.1f} times what the wheel speeds err by",
            expected=f"up to {_MOST:.0f} times",
            do="; or ".join([*likely, "a wheel speed that is late, or coarse"])
            + ": look at the log with `brake-cal check`",
        )
    eta, slip = (np.concatenate(x) for x in zip(*left, strict=True))
    figures = {
        "residual_eta_rms_sigma": _rms(eta),
        "residual_slip_rms_sigma": _rms(slip),
        "outliers": float(np.count_nonzero(np.abs(eta) > SETTINGS.outlier)),
    }
    return found, figures


def _left(car: Vehicle, e: Ensemble, runs: Sequence[RampRun]) -> list[tuple[Array, Array]]:
    """What is left of eta and slip of each ramp on which both axles brake."""
    return [residuals(car, e, run) for run in runs if run.only is None]


def residuals(car: Vehicle, e: Ensemble, run: RampRun) -> tuple[Array, Array]:
    """Of eta and of slip, over their sigma, at the braked blocks (k,); no slip without v.

    A noisy z counts, as the forces of a block are those of its z: on a rough road by five times the
    noise of quiet wheels.
    """
    of = Regression(car, [run], most=None)
    (ramp,) = of.ramps
    z, seen = ramp.z[1:], run.noise.z / np.sqrt(run.blocks.length)
    forces = np.repeat(np.abs(ramp.rows @ z) / (z @ z) * seen, z.size)
    errors = of.errors["noise"], of.errors["tyres"], forces[:, None]
    sigma = np.linalg.norm(np.hstack(errors), axis=1)
    lasting = np.hstack([of.errors["zeros"], of.errors["accelerometer"]])
    left = of.left(e.take(np.linspace(0, e.size - 1, _SOME).astype(np.int64)))
    left -= left @ of.white.T @ of.white @ lasting @ lasting.T  # as far as the run tells them
    eta, slip = np.split(np.median(left, axis=0) / sigma, 2)
    return eta, slip[:0] if run.slip is None else slip


def _rms(x: Array) -> float:
    return float(np.linalg.norm(x) / np.sqrt(max(x.size, 1)))


def metrics(vehicle: Vehicle, runs: list[RampRun], of: Shown, nominal: float) -> dict[str, float]:
    """Quality metrics of the fit, each a plain number, beside those of what is left of the ramps.

    ``of`` draws of the ``runs`` up to the highest z; ``nominal`` weight of what was known of the
    pads' ratio before them in what is known now [1].
    """
    z_peak, eta_peak, real = find_peak(of)
    return {
        "deceleration_max": float(of.z[-1]),
        "front_biased_up_to": min(front_biased_up_to(vehicle), 9.99),
        "eta_peak": eta_peak,
        "eta_peak_deceleration": z_peak,
        "eta_peak_is_real": float(real),
        "pad_ratio_nominal_weight": nominal,
        "runs": float(len(runs)),
    }


def remarks(
    vehicle: Vehicle, mass: MassUsed, runs: list[RampRun], held: Sequence[tuple[Known, float]]
) -> Iterator[str]:
    """What was decided that neither the numbers of the table nor its warnings say, in words.

    ``vehicle`` and ``mass`` as in the logs; ``held`` how likely each thing known before holds.
    """
    if vehicle.effects.described:
        yield f"known effects taken out of the logs: {', '.join(vehicle.effects.described)}"
    if mass.stated:
        yield f"mass in the logs: {mass}"
    for run in runs:
        b = run.blocks
        zero = float(np.mean(b.eta[run.rolling])) - 1.0
        yield f"{run.name}: eta zeroed by {100 * zero:+.3f} % (rolling radii)"
        for first, after in [] if run.left_out is None else runs_of(run.left_out):
            start, end = b.end[first] - b.length, b.end[after - 1]
            yield f"{run.name}: left out from {start:.2f} to {end:.2f} s: a bump, another force"
    for one, p in held:
        yield f"what {one.name} says holds for this car with {100.0 * p:.0f} %, by its ramps"


def warnings_of(
    filed: Vehicle, ramps: Sequence[Run], coasts: Sequence[Run], known: Resistance
) -> Iterator[PlausibilityWarning]:
    """Warnings which need no fit: it says itself what it thinks of the pads.

    ``filed`` the vehicle as its file has it; ``known`` the resistance that was identified, doubted
    where the file does not give it. A ramp is compared with that of the coasts alone, and with
    their course, where there are any.
    """
    yield from (w for w in plausible(filed) if not w.code.startswith("pad_friction"))
    car = ramps[0].car
    if ROLLING[0] not in car.effects:
        yield from judged(car.name, [Measured("rolling_resistance", known.mean[1])])
    rolling = identify_resistance(car, ((x.blocks, x.noise.z) for x in coasts)) if coasts else known
    straight = {FIT: coasts, COAST: ()}
    runs = [(run, FIT, rolling) for run in ramps] + [(run, COAST, known) for run in coasts]
    for run, purpose, resistance in runs:
        sensor, response = run.accelerometer(resistance), run.response(known.effects)
        yield from warnings_on(Evidence(run, sensor, response, straight[purpose]), purpose)
