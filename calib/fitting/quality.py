"""How good a fit is: numbers, the words that its user must read, what files and logs say of it."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from calib.base.arrays import Array
from calib.base.warning import Measured, PlausibilityWarning, judged
from calib.car.bias import front_biased_up_to
from calib.car.mass import MassUsed
from calib.car.plausible import plausible
from calib.car.vehicle import Vehicle
from calib.fitting.curves import Ridge, find_peak
from calib.fitting.known import Known
from calib.fitting.residuals import Residuals
from calib.model.ramp import RampRun
from calib.model.resistance import ROLLING, Resistance
from calib.model.resistance import identify as identify_resistance
from calib.model.roller_bench import RollerBench
from calib.model.sensors import judge_accelerometer
from calib.model.settings import SETTINGS
from calib.model.sort_logs import Prepared
from calib.plausibility.run import of_bend, run_warnings
from calib.run.axle_signals import signals
from calib.run.brake_response import brake_balance, brake_response
from calib.run.filters import runs as runs_of
from calib.table.table import Calibration


def metrics(
    vehicle: Vehicle, runs: list[RampRun], left: Residuals, of: Ridge, nominal: float
) -> dict[str, float]:
    """Quality metrics of the fit, each a plain number.

    ``left`` residuals of the ``runs``, ``of`` their draws up to the highest z;
    ``nominal`` weight of what was known of the pads' ratio before them in what is known now [1].
    """
    z_peak, eta_peak, real = find_peak(of)
    eta, slip = (np.concatenate(x) for x in zip(*left, strict=True))
    return {
        "deceleration_max": float(of.z[-1]),
        "front_biased_up_to": min(front_biased_up_to(vehicle), 9.99),
        "eta_peak": eta_peak,
        "eta_peak_deceleration": z_peak,
        "eta_peak_is_real": float(real),
        "residual_eta_rms_sigma": float(np.sqrt(np.mean(eta**2))),
        "residual_slip_rms_sigma": float(np.sqrt(np.mean(slip**2))) if slip.size else 0.0,
        "outliers": float(np.count_nonzero(np.abs(eta) > SETTINGS.outlier)),
        "pad_ratio_nominal_weight": nominal,
        "runs": float(len(runs)),
    }


def remarks(
    vehicle: Vehicle,
    mass: MassUsed,
    runs: list[RampRun],
    left: Residuals,
    pads: Calibration,
    known: Resistance,
    quality: Mapping[str, float],
    coasts: Sequence[Prepared],
    bench: RollerBench | None,
    held: Sequence[tuple[Known, float]],
) -> Iterator[str]:
    """What the user must know of this table, in words.

    ``vehicle`` and ``mass`` as in the logs; ``left``, ``quality`` as of `metrics`; ``held``
    what was known before, with how likely it holds.
    """
    if vehicle.effects.described:
        yield f"known effects taken out of the logs: {', '.join(vehicle.effects.described)}"
    if mass.stated:
        yield f"mass in the logs: {mass}"
    for run, (of_eta, _) in zip(runs, left, strict=True):
        yield from _of_run(run, of_eta)
    if not known.known and not coasts:
        yield (
            "drag and rolling resistance share one lead-in: their sum is measured, their parts "
            "are usual values; add a coast log, or give them in the vehicle file"
        )
    if all(run.blocks.v is None for run in runs):
        on = "vehicle file" if bench is None else "roller brake tester"
        yield (
            "no reference speed: slip stiffness and pad ratio cannot be told apart, the ratio "
            f"rests on the {on}"
        )
    if quality["eta_peak_is_real"]:
        yield (
            f"eta peaks at {quality['eta_peak_deceleration']:.2f} g: f1, f2 of eta end before it; "
            "beyond, use the tyre curve"
        )
    ratio = pads.pad_log_ratio
    low, high = np.exp(ratio.ci95)
    if not low < 1.0 < high:
        yield (
            "the pads were not in the ratio of the vehicle file: front/rear "
            f"{np.exp(ratio.value):.2f} times nominal, 95 % {low:.2f} to {high:.2f}"
        )
    if bench is not None:
        stated, level = bench.log_pad_ratio(vehicle), bench.log_pad_level(vehicle)
        apart = np.exp(level.value) / pads.pad_scale.value
        yield (
            f"roller brake tester {bench.name}: pads front/rear {np.exp(stated.value):.3f} times "
            f"nominal, known to {100.0 * stated.sigma:.2g} %, one sigma; their level is "
            f"{apart:.2f} times that of the ramps, which counts"
        )
    for one, p in held:
        yield f"what {one.name} says holds for this car with {100.0 * p:.0f} %, by its ramps"


def _of_run(run: RampRun, of_eta: Array) -> Iterator[str]:
    b = run.blocks
    zero = float(np.mean(b.eta[run.rolling])) - 1.0
    yield f"{run.name}: eta zeroed by {100 * zero:+.3f} % (rolling radii)"
    for first, after in [] if run.left_out is None else runs_of(run.left_out):
        yield (
            f"{run.name}: left out from {b.end[first] - b.length:.2f} to {b.end[after - 1]:.2f} s, "
            "where something acts that the pressure does not make: a bump, a gear shift, another "
            "road"
        )
    far = np.flatnonzero(np.abs(of_eta) > SETTINGS.outlier)
    if far.size:
        listed = ", ".join(f"{t:.2f}" for t in b.end[run.braked][far[:5]])
        yield f"{run.name}: {far.size} outlying blocks of eta, at {listed} s"


def warnings_of(
    filed: Vehicle, car: Vehicle, ramps: list[Prepared], coasts: list[Prepared], known: Resistance
) -> Iterator[PlausibilityWarning]:
    """Warnings which need no fit: it says itself what it thinks of the pads.

    ``car`` as its effects leave it of the ``filed`` one; ``ramps``, ``coasts`` with the blocks as
    read; ``known`` the resistance that was identified, doubted where the file does not give it. A
    ramp is compared with that of the coasts alone, and with their course, where there are any.
    """
    yield from (w for w in plausible(filed) if not w.code.startswith("pad_friction"))
    effect, name = ROLLING
    if effect not in car.effects:
        found = known.effects.parameters[effect][name]
        yield from judged(car.name, [Measured("rolling_resistance", found)])
    straight, coasted = [log for log, _, _ in coasts], [(b, noise.z) for _, b, noise in coasts]
    rolling = identify_resistance(car, coasted) if coasts else known
    runs = [(run, rolling, straight) for run in ramps] + [(run, known, []) for run in coasts]
    for (log, b, noise), resistance, others in runs:
        s = signals(log, car)
        sensor = judge_accelerometer(car, resistance, b, noise)
        response = brake_response(s, brake_balance(car, known.effects, s))
        yield from run_warnings(log, s, car, sensor, response)
        yield from judged(log.name, of_bend(log, s, car.track_width, others))
