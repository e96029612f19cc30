"""Lateral acceleration by left and right wheel, of a car that rolls or brakes in a bend."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.names import G
from calib.run.axle_signals import signals
from calib.run.lateral import lateral
from tests.support.reference_car import CAR, REAL, ramp

HEIGHT, WIDTH, TURNED, SLIP = 0.55, 1.5, 2.5, 0.015


def in_a_bend(braked):
    """A log whose rear wheels turn as in a left bend of 2.5 m/s^2, by the slip of each wheel."""
    log = ramp(REAL)
    s = signals(log, CAR.rear.rolling_radius)
    half = 0.5 * WIDTH * TURNED / np.maximum(s.speed, 1.0) ** 2
    more = 2.0 * TURNED * HEIGHT / (G * WIDTH)  # load of the outer wheel, over its own
    slips = [SLIP * braked / (1.0 + side * more) for side in (-1.0, 1.0)]
    turns = [(1.0 + side * half) * (1.0 - slip) for side, slip in zip((-1, 1), slips, strict=True)]
    speed = s.speed / CAR.rear.rolling_radius
    wheels = {"omega_rl": turns[0] * speed, "omega_rr": turns[1] * speed}
    return replace(log, channels={**log.channels, **wheels}), s


def test_a_rolling_car_shows_its_bend():
    log, s = in_a_bend(braked=0.0)
    assert lateral(log, s, WIDTH)[s.speed > 10.0] == pytest.approx(TURNED, rel=1e-3)


def test_a_braking_car_shows_its_bend_if_its_slip_is_known():
    """The unequal slips of both sides look like half a bend more."""
    log, s = in_a_bend(braked=1.0)
    fast = s.speed > 20.0
    assert np.all(lateral(log, s, WIDTH)[fast] > 1.5 * TURNED)
    leaned = lateral(log, s, WIDTH, slip=SLIP, height=HEIGHT)[fast]
    assert leaned == pytest.approx(TURNED, rel=0.06)  # (1 + x)/(1 - x) is not 1 + 2 x
