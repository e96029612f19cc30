"""What speaks against an estimate although it is valid: the likely sensor or part, by name.

Exchanged axles show 1/eta. The likelihoods of eta and of 1/eta over z are compared, each a mean
over the scenarios of `calib.fitting.maps`. A front wheel exchanged with the rear one of the other
side leaves eta flat and the sides apart, see `calib.run.exchanged_wheels`; wheels of one side are
refused before a stop is estimated.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

import numpy as np

from calib.base.arrays import Array
from calib.base.intervals import Z95
from calib.base.names import G
from calib.base.warning import (
    VOID,
    WARN,
    Measured,
    PlausibilityWarning,
    rule_warnings,
    unexplained,
)
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
from calib.plausibility.pads import of_changes
from calib.plausibility.rules import VALIDATE, warnings_on
from calib.run.brake_response import brake_response
from calib.run.exchanged_wheels import crossed_diagonal
from calib.run.resistance import Resistance
from calib.run.run import Run
from calib.table.budget import pad_levels
from calib.table.table import Table

_BINS = np.array([0.05, 0.08, 0.12, 0.17, 0.24, 0.33, 0.45, 0.6, 1.0])
"""Decelerations [1] between which blocks are averaged."""
_Z = np.geomspace(_BINS[0], _BINS[-1], 25)
"""Decelerations [1] between which scenarios are linear: near its peak a tyre is not for long."""
_COUNT = 4096  # of scenarios
_FORM = 0.03  # of eta - 1, relative: forms of tyres, and loads that move late
_FINEST = 5e-5  # least error of a mean of eta - 1 [1]
_ASKS = {
    *("level_changed", "pads_changed_apart", "unexplained_braking_force", "force_step"),
    *("braking_force_missing", "unexplained_drag", "a_x_by_wheels", "v_of_wheels", "v_scale"),
}
"""Warnings after which mistakes are compared, which takes as long as the rest of a stop."""
_FEWEST, _SURELY, _LATE, _BESIDE = 20, 4.0, 0.5 * DELAYS[0], 0.025
"""From these on mistakes are compared: blocks of a braking, a delay of the wheels in sigma and [s],
share of brake force beside the pressure [1]. Good stops have delays of up to 6 ms, by the form of
the tyres; at 13 ms none is named yet, at 20 ms 8 ms and more are seen."""
_ZEROED, _NOT_ZEROED = 5e-5, 0.01  # sigma of the zero of eta [1], with a lead-in and without


def warnings_of(e: Estimate, run: Run | None = None) -> tuple[PlausibilityWarning, ...]:
    """All that speaks against an estimate, also what makes it void.

    ``run`` the log as read, if samples were filled into its gaps.
    """
    log_run = run or e.run
    resistance = known_resistance(e.table)
    evidence = Evidence(
        log_run, e.run.accelerometer(resistance, e.noise), brake_response(e.read, e.forces)
    )
    of_table = [Measured("axles_exchanged", axles_exchanged(e.table, e))]
    if (parts := log_run.wheels) is not None:
        expected = float(np.interp(parts.z, e.table.paper.z, e.table.paper.eta)) - 1.0
        if crossed := crossed_diagonal(parts, expected):
            of_table.append(Measured("wheels_crossed", crossed.part, words={"found": crossed}))
    if e.valid.any():
        i = int(np.flatnonzero(e.valid)[-1])
        middle, low, high = e.best.step.change[:, i].tolist()
        apart = middle, (high - low) / (2.0 * Z95)
        of_table += of_changes(_together(e, resistance, i), apart)
    does = VOID, WARN
    warnings = (
        *warnings_on(evidence, VALIDATE, does),
        *rule_warnings(log_run.log.name, of_table, VALIDATE, does),
    )
    asks = any(one.code in _ASKS for one in warnings) or share(e.valid, counted_samples(e)) <= 0.5
    asks = asks or _beside_pressure(evidence) or _goes_with_time(e)
    rolls = log_run.slipping is not None and not (
        log_run.slipping.locked or log_run.slipping.cycles
    )
    named = _mistakes(e, resistance, evidence) if asks and rolls else ()
    by_mistake = rule_warnings(log_run.log.name, named, VALIDATE)
    return (*unexplained(by_mistake, warnings), *warnings)


def _beside_pressure(evidence: Evidence) -> bool:
    """Whether some brake force does not follow the pressure, less than a warning needs."""
    response = evidence.response
    return response is not None and abs(response.share) > max(_BESIDE, 1.5 * response.share_sigma)


def _goes_with_time(e: Estimate) -> bool:
    """Whether a part of eta goes with z over the speed, as late wheel speeds make it."""
    b = e.blocks
    use = (np.maximum(b.p_f, b.p_r) > BITE) & (b.speed > MOVING)
    if np.count_nonzero(use) < _FEWEST or not b.lead_in.any():
        return False
    z = b.z[use]
    sigma = b.eta[use] * np.sqrt(2.0 / b.length) * e.noise.omega / np.maximum(b.omega_f[use], 1.0)
    columns = np.stack([z, z**2, G * z / b.speed[use], np.ones_like(z)], axis=1) / sigma[:, None]
    solution = np.linalg.lstsq(columns, b.eta[use] / sigma)[0]
    sigma_delay = math.sqrt(np.linalg.pinv(columns.T @ columns)[2, 2])
    return abs(float(solution[2])) > max(_LATE, _SURELY * sigma_delay)


def _mistakes(e: Estimate, resistance: Resistance, evidence: Evidence) -> Iterator[Measured]:
    """Mistakes that explain a stop better than other pads than the ramp's, most probable first."""
    cal, car = e.table.calibration, e.run.car
    car = car.with_pads(cal.pad_friction_f.value, cal.pad_friction_r.value)
    car = replace(car, motor_odds=max(car.motor_odds, LEAST_ODDS))
    ramp = prepare(e.run, resistance.effects, evidence.accelerometer)
    try:
        yield from measured(causes_of(car, [ramp], other_road=True), beside_pads=False)
    except ValueError:  # nothing rolls before the stop, or nothing of it is steady
        return


def _together(e: Estimate, resistance: Resistance, i: int) -> tuple[float, float]:
    """ln of the brake force over that of the ramp's pads, at a sample; its sigma.

    The sigma does not count the mass: another load is what this would show.
    """
    best = e.best
    slowing = float(resistance.sigma_z(e.car, e.read.speed[i : i + 1])[0])
    variance = float(best.step.noise[i] + best.step.accelerometer[i])
    variance += (slowing / max(float(e.read.z[i]), 0.02)) ** 2
    variance += sum(x for part, x in e.table.budget.level.items() if part != "mass")
    ramp = pad_levels(e.table.vehicle, e.table.calibration).level
    return math.log(best.level.value[i]) - ramp, math.sqrt(variance)


def axles_exchanged(table: Table, e: Estimate) -> float:
    """Logarithm of the likelihood of eta with the axles exchanged over that as given.

    0 where the car never brakes, or brakes with the rear axle alone.
    """
    z, shift, error = _curve(e)
    if not z.size or e.run.alone == "r":
        return 0.0
    shown = _shown(table) @ np.stack([np.interp(z, _Z, hat) for hat in np.eye(_Z.size)])
    zero = _ZEROED if e.read.lead_in.any() else _NOT_ZEROED
    whiten = np.linalg.cholesky(np.linalg.inv(np.diag(error**2) + zero**2))
    as_given, other = (
        np.logaddexp.reduce(-0.5 * np.sum(((x - shown) @ whiten) ** 2, axis=1))
        for x in (shift, 1.0 / (1.0 + shift) - 1.0)
    )
    return float(other - as_given)


@lru_cache(maxsize=2)  # a batch has one table
def _shown(table: Table) -> Array:
    """Eta - 1 that stops with a table's car would show at `_Z` [1], (n, k)."""
    car = table.vehicle
    stops = scenarios(car, ensemble_of(car, table.draws), _COUNT)
    return predict_stops(car, stops, _Z).eta_rise


def _curve(e: Estimate) -> tuple[Array, Array, Array]:
    """Demanded brake force over the weight, eta - 1 and its error, means within `_BINS`.

    Without wheels at their limit, which no scenario has.
    """
    b, demanded = e.blocks, e.best.inputs.demand
    shift = (1.0 + e.best.inputs.eta_less_1) / e.zeros[0] - 1.0
    variance = 2.0 * (e.noise.omega / np.maximum(b.omega_f, 1.0)) ** 2 / b.length
    rolls = ~np.isin(e.best.inputs.disturbed, (Reason.LOCKED, Reason.FAULT))
    use = (np.maximum(b.p_f, b.p_r) > BITE) & (b.speed > MOVING) & rolls
    use &= (demanded > _BINS[0]) & (demanded <= _BINS[-1])
    between = np.digitize(demanded[use], _BINS, right=True)
    _, place, count = np.unique(between, return_inverse=True, return_counts=True)
    z, mean, spread = (np.bincount(place, x[use]) / count for x in (demanded, shift, variance))
    return z, mean, np.sqrt(spread / count + (_FORM * mean) ** 2 + _FINEST**2)
