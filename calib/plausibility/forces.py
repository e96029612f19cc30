"""Figures of the forces of a run with its vehicle: accelerometer, brakes, a bend.

The column `figure` of `rules.csv` names the public function here that measures a rule.
"""

import math
from collections.abc import Iterator
from statistics import median

import numpy as np

from calib.base.intervals import likelihood_ratio
from calib.base.names import G
from calib.base.warning import Measured
from calib.car.braking import BITE, MOVING
from calib.plausibility.acceleration_delay import acceleration_delay
from calib.plausibility.evidence import Evidence
from calib.run.blocks import BLOCK
from calib.run.driving_record import NOMINAL_RADIUS
from calib.run.lateral import lateral, sides

_SLOPE_CHANGES = 0.5  # probability of a changing slope from which a_x is compared with v [1]
_MOTOR = 0.67
"""Posterior odds from which a motor is reported [1]; low, since a motor that is not reported would
be taken for other pads."""
LEAST_ODDS = 0.01  # least prior odds of a motor, even where the vehicle file says there is none [1]
_FORCE = 0.1  # prior sigma of a motor's force over the usual brake force [1]; usual: 0.03 to 0.3
_USUAL = 0.015
"""Sigma of a force without pressure where there is no motor, over the brake force [1]: the bite of
the pads, and an error of 0.5 bar in 30 of the zero of p_mc."""
_FADING = 0.02
"""Sigma of a force that fades with the speed where there is no motor, over the brake force [1]:
slow noise in the half second below 3 m/s."""
_UPRIGHT = 0.1  # largest deceleration for a bend [1]: above it the inner wheels slip more
_LEAST_Z = 0.1  # the noise of z is divided by the usual z of a braking, at least by this [1]
_STEP_NOISE = 3.2
"""Sigma of the difference of two medians over 0.3 s, over the density of the noise [1/s^0.5]: that
of a median is 1.25 times that of a mean, and 1.25 sqrt(2/0.3) is 3.2."""


def bend(evidence: Evidence) -> Iterator[Measured]:
    """Mean lateral acceleration [m/s^2]; it needs ``straight`` runs, which show the radii."""
    run, s = evidence.run, evidence.run.signals
    upright = (s.speed > MOVING) & (s.z < _UPRIGHT)
    if evidence.straight and upright.any():
        sum_moving = 2.0 * MOVING / NOMINAL_RADIUS  # of the speeds of both rear wheels [rad/s]
        logs = [run.log for run in evidence.straight]
        ratios = [sides(log)[log["omega_rl"] + log["omega_rr"] > sum_moving] for log in logs]
        straight = float(np.mean(np.concatenate(ratios)))
        lateral_acceleration = lateral(run.log, s, run.car.track_width, straight)
        yield Measured("bend", float(np.mean(lateral_acceleration[upright])))


def accelerometer(evidence: Evidence) -> Iterator[Measured]:
    """Scale of a_x, slope of the road, offset and drag."""
    run, sensor = evidence.run, evidence.accelerometer
    if sensor is None:
        return
    if run.other_scale == 0.0:
        scale = sensor.scale / (1.0 - sensor.scale)
        yield Measured("a_x_scale", scale, math.sqrt(sensor.variance_scale))
    if sensor.walk_probability > _SLOPE_CHANGES:
        # the change of v over 1 s, between two blocks, is compared with the mean of a_x
        sigma = math.hypot(run.noise.z, math.sqrt(2.0 / BLOCK) * run.noise.v / G)
        yield Measured("a_x_against_v", sensor.disagreement, sigma)
    yield Measured("a_x_offset", -G * sensor.bias, G * math.sqrt(sensor.variance_bias))
    yield Measured("unexplained_drag", G * sensor.drag)


def a_x_late(evidence: Evidence) -> Iterator[Measured]:
    """Delay of a_x against v, or against the wheel speeds."""
    delay = acceleration_delay(evidence.run) if evidence.run.vehicle else None
    if delay is not None:
        yield Measured("a_x_late", delay.value, delay.sigma, words={"against": delay.against})


def brakes(evidence: Evidence) -> Iterator[Measured]:
    """Force without pressure, and the delay of the brakes.

    A motor that brakes as soon as the pedal is touched adds a force without pressure. One that
    hands over to the brakes before the car stands is a force that fades with the speed, which only
    a run braked to below 3 m/s shows. Either force and both together have the same prior odds.
    """
    response, vehicle = evidence.response, evidence.run.vehicle
    if response is None or vehicle is None:
        return
    early_sigma = math.hypot(response.share_sigma, _USUAL)
    fading_sigma = math.hypot(response.fading_sigma, _FADING)
    early = likelihood_ratio(response.share, early_sigma, _FORCE)
    fading = likelihood_ratio(response.fading, fading_sigma, _FORCE)
    odds = max(vehicle.motor_odds, LEAST_ODDS)
    if odds * (early + fading + early * fading) / 3.0 > _MOTOR:
        force = response.share if early > fading else response.fading
        yield Measured("unexplained_braking_force", force)
    yield Measured("braking_force_missing", response.share, response.share_sigma)
    yield Measured("pressure_lag", response.delay, response.delay_sigma)


def force_step(evidence: Evidence) -> Iterator[Measured]:
    """The largest step of the force without one of the pressure, and sigma of such steps."""
    run, response = evidence.run, evidence.response
    if response is None or run.vehicle is None:
        return
    time, step, scatter = response.force_step
    b = run.blocks
    braked = (np.maximum(b.p_f, b.p_r) > BITE) & (b.speed > MOVING)
    usual_z = max(float(np.median(b.z[braked])), _LEAST_Z) if braked.any() else 1.0
    noise = _STEP_NOISE * run.lead_in_noise.z / usual_z  # few steps scatter little by chance
    yield Measured("force_step", step, max(scatter, noise), words={"at": time})


def levels(evidence: Evidence) -> Iterator[Measured]:
    """Level of the brakes over the median of two or more other logs of a diagnosis (logarithm)."""
    response = evidence.response
    if response is not None and len(evidence.levels) >= 2:
        change = math.log(response.level / median(evidence.levels))
        yield Measured("level_changed", change, to_display=math.expm1)
