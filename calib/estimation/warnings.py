"""Warn of sensors and parts that make an estimate doubtful although it is valid.

`warnings_of` collects the warnings of all rules for a validation. Three groups are made here:

* Exchanged axles show 1/eta. The likelihoods of eta and of 1/eta over z are compared, each a mean
  over the scenarios of `calib.fitting.maps`: drawn stops with the table's car.
* A front wheel exchanged with the rear wheel of the other side leaves eta flat and the sides apart,
  see `calib.run.exchanged_wheels`. Exchanged wheels of one side are refused before an estimate.
* Mistakes of the log or the vehicle file that explain a stop better than other pads do, see
  `calib.fitting.mistakes`. They are compared only after a hint, since that doubles the time.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

import numpy as np

from calib.base.arrays import Array
from calib.base.intervals import Z95
from calib.base.names import G
from calib.base.warning import VOID, WARN, Measured, PlausibilityWarning, rule_warnings, unexplained
from calib.car.braking import BITE, MOVING
from calib.estimation.estimator import Estimate
from calib.estimation.known import known_resistance
from calib.estimation.metrics import counted_samples, share
from calib.estimation.reasons import Reason
from calib.fitting.ensemble import ensemble_of
from calib.fitting.hypotheses import DELAYS
from calib.fitting.maps import predict_stops, scenarios
from calib.fitting.mistakes import causes_of, measured
from calib.model.ramp import prepare
from calib.plausibility.evidence import Evidence
from calib.plausibility.forces import LEAST_ODDS
from calib.plausibility.pads import change_figures
from calib.plausibility.rules import VALIDATE, warnings_on
from calib.run.brake_response import brake_response
from calib.run.exchanged_wheels import crossed_diagonal
from calib.run.resistance import Resistance
from calib.run.run import Run
from calib.table.budget import level_and_ratio
from calib.table.table import Table

_BINS = np.array([0.05, 0.08, 0.12, 0.17, 0.24, 0.33, 0.45, 0.6, 1.0])
"""Decelerations [1] between which blocks are averaged."""
_Z = np.geomspace(_BINS[0], _BINS[-1], 25)
"""Decelerations [1] between which eta of a scenario is interpolated."""
_COUNT = 4096  # number of scenarios
_MODEL_ERROR = 0.03  # relative error of eta - 1 by tyre curves, and by loads that follow late [1]
_LEAST_ERROR = 5e-5  # least error of a mean of eta - 1 [1]
_HINTS = {
    "level_changed", "pads_changed_apart", "unexplained_braking_force", "force_step",
    "braking_force_missing", "unexplained_drag", "a_x_by_wheels", "v_of_wheels", "v_scale",
}  # fmt: skip
"""Codes of warnings after which mistakes are compared."""
_FEWEST = 20  # braked blocks from which on a delay of the wheels is estimated
_LATE_SIGMA, _LATE = 4.0, 0.5 * DELAYS[0]
"""Delay of the wheels from which on mistakes are compared [sigma], [s]. Good stops show up to 6 ms
by their tyre curves; a delay of 20 ms shows as 8 ms or more."""
_NOT_BY_PRESSURE = 0.025  # share of the brake force from which on mistakes are compared [1]
_ZEROED, _NOT_ZEROED = 5e-5, 0.01  # sigma of the zero of eta [1], with a lead-in and without


def warnings_of(e: Estimate, run: Run | None = None) -> tuple[PlausibilityWarning, ...]:
    """Return all warnings of an estimate; ``run`` is the log as read, if its gaps were filled."""
    log_run = run or e.run
    resistance = known_resistance(e.table)
    accelerometer = e.run.accelerometer(resistance, e.noise)
    evidence = Evidence(log_run, accelerometer, brake_response(e.signals, e.forces))
    by_table = [Measured("axles_exchanged", axles_exchanged(e.table, e))]
    wheels = log_run.wheels
    if wheels is not None:
        expected = float(np.interp(wheels.z, e.table.paper.z, e.table.paper.eta)) - 1.0
        crossed = crossed_diagonal(wheels, expected)
        if crossed:
            words = {"found": crossed}  # the cause of the rule names the wheels in place of {found}
            by_table.append(Measured("wheels_crossed", crossed.part, words=words))
    if e.valid.any():
        last = int(np.flatnonzero(e.valid)[-1])
        ratio, low, high = e.best.step.change[:, last].tolist()
        ratio_change = ratio, (high - low) / (2.0 * Z95)
        by_table += change_figures(_level_change(e, resistance, last), ratio_change)
    kinds = VOID, WARN
    warnings = (
        *warnings_on(evidence, VALIDATE, kinds),
        *rule_warnings(log_run.log.name, by_table, VALIDATE, kinds),
    )
    may_be_mistake = (
        any(warning.code in _HINTS for warning in warnings)
        or share(e.valid, counted_samples(e)) <= 0.5
        or _has_force_without_pressure(evidence)
        or _is_late(e)
    )
    slipping = log_run.slipping
    rolls = slipping is not None and not (slipping.locked or slipping.cycles)
    named = _mistakes(e, resistance, evidence) if may_be_mistake and rolls else ()
    by_mistake = rule_warnings(log_run.log.name, named, VALIDATE)
    return (*unexplained(by_mistake, warnings), *warnings)


def _has_force_without_pressure(evidence: Evidence) -> bool:
    """Return whether a part of the brake force, maybe too small for a warning, has no pressure."""
    response = evidence.response
    if response is None:
        return False
    return abs(response.share) > max(_NOT_BY_PRESSURE, 1.5 * response.share_sigma)


def _is_late(e: Estimate) -> bool:
    """Return whether eta has a part d g z/v: wheels logged late by d seem to be d g z faster."""
    b = e.run.blocks
    use = (np.maximum(b.p_f, b.p_r) > BITE) & (b.speed > MOVING)
    if np.count_nonzero(use) < _FEWEST or not b.lead_in.any():
        return False
    z = b.z[use]
    sigma = b.eta[use] * np.sqrt(2.0 / b.length) * e.noise.omega / np.maximum(b.omega_f[use], 1.0)
    terms = np.stack([z, z**2, G * z / b.speed[use], np.ones_like(z)], axis=1) / sigma[:, None]
    delay = float(np.linalg.lstsq(terms, b.eta[use] / sigma)[0][2])
    sigma_delay = math.sqrt(np.linalg.pinv(terms.T @ terms)[2, 2])
    return abs(delay) > max(_LATE, _LATE_SIGMA * sigma_delay)


def _mistakes(e: Estimate, resistance: Resistance, evidence: Evidence) -> Iterator[Measured]:
    """Yield mistakes that explain a stop better than other pads do, most probable first."""
    ramp_pads = e.table.calibration
    car = e.run.car.with_pads(ramp_pads.pad_friction_f.value, ramp_pads.pad_friction_r.value)
    car = replace(car, motor_odds=max(car.motor_odds, LEAST_ODDS))  # even if the file says 0
    stop = prepare(e.run, resistance.effects, evidence.accelerometer)
    try:
        yield from measured(causes_of(car, [stop], other_road=True), beside_pads=False)
    except ValueError:  # nothing rolls before the stop, or nothing of it is steady
        return


def _level_change(e: Estimate, resistance: Resistance, i: int) -> tuple[float, float]:
    """Return ln of the brake force over that of the ramp's pads [1] at sample ``i``, and sigma."""
    best = e.best
    sigma_z = float(resistance.sigma_z(e.car, e.signals.speed[i : i + 1])[0])
    variance = float(best.step.noise[i] + best.step.accelerometer[i])
    variance += (sigma_z / max(float(e.signals.z[i]), 0.02)) ** 2
    # without the error of the mass, so that another load shows
    variance += sum(x for part, x in e.table.budget.level.items() if part != "mass")
    log_level_of_ramp = level_and_ratio(e.table.vehicle, e.table.calibration).level
    return math.log(best.level.value[i]) - log_level_of_ramp, math.sqrt(variance)


def axles_exchanged(table: Table, e: Estimate) -> float:
    """Return ln of the likelihood ratio of exchanged axles over axles as given, by eta."""
    z, eta_rise, error = _curve(e)
    if not z.size or e.run.alone == "r":  # the car never brakes, or with the rear axle alone
        return 0.0
    # weights (25, k) of linear interpolation from `_Z` to z; eta - 1 of the scenarios (4096, k)
    weights = np.stack([np.interp(z, _Z, unit) for unit in np.eye(_Z.size)])
    predicted = _eta_rises(table) @ weights
    zero = _ZEROED if e.signals.lead_in.any() else _NOT_ZEROED
    covariance = np.diag(error**2) + zero**2  # the error of the zero is common to all
    whiten = np.linalg.cholesky(np.linalg.inv(covariance))
    as_given, exchanged = (
        np.logaddexp.reduce(-0.5 * np.sum(((x - predicted) @ whiten) ** 2, axis=1))
        for x in (eta_rise, 1.0 / (1.0 + eta_rise) - 1.0)
    )
    return float(exchanged - as_given)


@lru_cache(maxsize=2)  # a batch has one table
def _eta_rises(table: Table) -> Array:
    """Return eta - 1 of scenarios with a table's car at `_Z` (4096, 25) [1]."""
    car = table.vehicle
    stops = scenarios(car, ensemble_of(car, table.draws), _COUNT)
    return predict_stops(car, stops, _Z).eta_rise


def _curve(e: Estimate) -> tuple[Array, Array, Array]:
    """Return brake force over weight, eta - 1 and the error of eta, (k,) each: means in `_BINS`."""
    b, demanded = e.run.blocks, e.best.inputs.demand
    eta_rise = (1.0 + e.best.inputs.eta_less_1) / e.zeros[0] - 1.0
    variance = 2.0 * (e.noise.omega / np.maximum(b.omega_f, 1.0)) ** 2 / b.length
    # no scenario has locked wheels or faults
    rolls = ~np.isin(e.best.inputs.disturbed, (Reason.LOCKED, Reason.FAULT))
    use = (np.maximum(b.p_f, b.p_r) > BITE) & (b.speed > MOVING) & rolls
    use &= (demanded > _BINS[0]) & (demanded <= _BINS[-1])
    bins = np.digitize(demanded[use], _BINS, right=True)
    _, place, count = np.unique(bins, return_inverse=True, return_counts=True)
    z, mean, noise = (np.bincount(place, x[use]) / count for x in (demanded, eta_rise, variance))
    return z, mean, np.sqrt(noise / count + (_MODEL_ERROR * mean) ** 2 + _LEAST_ERROR**2)
