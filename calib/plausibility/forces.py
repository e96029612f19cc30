"""Figures of the forces of a run with its vehicle: accelerometer, brakes, a bend.

Each function is a figure of `rules.csv` by its name. Nothing here changes an estimate.
"""

import math
from collections.abc import Iterator
from statistics import median

import numpy as np

from calib.base.intervals import likelihood_ratio
from calib.base.names import G
from calib.base.warning import Measured
from calib.car.braking import MOVING
from calib.plausibility.evidence import Evidence
from calib.run.driving_record import NOMINAL_RADIUS
from calib.run.lateral import lateral, sides

_WANDERS = 0.5  # chance of a slope that changes from which it is named [1]
_MOTOR, LEAST_ODDS = 0.67, 0.01
"""Odds from which a motor is named [1]: a false name costs a look, a motor that is not named moves
the pads. Least odds before the run, also where the vehicle file says that there is no motor."""
_FORCE = 0.1  # spread of a motor's force over the usual brake force [1]: 0.01 to 0.1 g beside 0.3 g
_USUAL, _FADING = 0.015, 0.02
"""Spread, where pads alone brake, of a force without pressure and of one that fades with the speed
[1]. The first: pads bite, and p_mc has its zero, within 0.5 of 30 bar. The second: slow noise in
the half second below 3 m/s. Pads that grip more at low speed are below zero."""
_UPRIGHT = 0.1
"""Deceleration [1] past which left and right are not compared: the inner wheels of a bend bear less
and slip more, which looks like a tighter one."""


def bend(e: Evidence) -> Iterator[Measured]:
    """Mean lateral acceleration [m/s^2] by runs of the same car that are ``straight``.

    Without such runs a bend and wheels of unlike radius look the same.
    """
    s = e.run.signals
    upright = (s.speed > MOVING) & (s.z < _UPRIGHT)
    if e.straight and upright.any():
        fast, logs = 2.0 * MOVING / NOMINAL_RADIUS, (run.log for run in e.straight)
        equal = [sides(log)[log["omega_rl"] + log["omega_rr"] > fast] for log in logs]
        straight = float(np.mean(np.concatenate(equal)))
        turned = lateral(e.run.log, s, e.run.car.track_width, straight)
        yield Measured("bend", float(np.mean(turned[upright])))


def accelerometer(e: Evidence) -> Iterator[Measured]:
    """Scale, slope, offset, drag and delay."""
    sensor = e.accelerometer
    if sensor is None:
        return
    if e.run.other_scale == 0.0:
        scale = sensor.scale / (1.0 - sensor.scale)
        yield Measured("a_x_scale", scale, math.sqrt(sensor.variance_scale))
    if sensor.wanders > _WANDERS:
        yield Measured("a_x_against_v", sensor.disagrees)
    yield Measured("a_x_offset", -G * sensor.bias, G * math.sqrt(sensor.variance_bias))
    yield Measured("unexplained_drag", G * sensor.drag)
    yield Measured("a_x_late", sensor.lag, math.sqrt(sensor.variance_lag))


def brakes(e: Evidence) -> Iterator[Measured]:
    """Force without pressure, a step of the force, and its delay.

    A motor that brakes from the first pressure on shows as a force without pressure. One that hands
    over to the brakes before the car stands shows as a force that fades with the speed. Either, and
    both, are as likely. A run that is not braked down to 3 m/s says nothing of the second.
    """
    response = e.response
    if response is None or e.run.vehicle is None:
        return
    share, fading_share = response.share, response.fading
    early = likelihood_ratio(share, math.hypot(response.share_sigma, _USUAL), _FORCE)
    fading = likelihood_ratio(fading_share, math.hypot(response.fading_sigma, _FADING), _FORCE)
    odds = max(e.run.vehicle.motor_odds, LEAST_ODDS)
    if odds * (early + fading + early * fading) / 3.0 > _MOTOR:
        yield Measured("unexplained_braking_force", share if early > fading else fading_share)
    yield Measured("braking_force_missing", share, response.share_sigma)
    time, step, scatter = response.step
    yield Measured("force_step", step, scatter, words={"at": time})
    yield Measured("pressure_lag", response.delay, response.delay_sigma)


def levels(e: Evidence) -> Iterator[Measured]:
    """Brakes of one log of a diagnosis over the median of the others (logarithm).

    Of fewer than two others nobody knows which log is wrong.
    """
    if e.response is not None and len(e.levels) >= 2:
        yield Measured(
            "level_changed", math.log(e.response.level / median(e.levels)), shown=math.expm1
        )
