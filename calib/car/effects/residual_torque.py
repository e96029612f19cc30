"""Residual torque: pads that do not come back after the first release.

clamp ^      .------.
      |    .'        '.
    r |  .'            '--...___       min(p, r) of the last application, draining
      +-'------------------------> t
"""

import numpy as np

from calib.car.braking import BITE
from calib.car.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.car.history import RunHistory


def pressure(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressure [Pa] that still clamps the pads: never less than what is left of an application.

    ``rear_bias`` is 0 when both axles keep it, 1 when only the rear one does, -1 the front one. An
    application is a pressure above `BITE`: the noise of a sensor leaves nothing. Not valid for
    pads that are knocked back by the disc.
    """
    most, bias = parameters["residual_pressure"], parameters["rear_bias"]
    if most <= 0.0:
        return p_f, p_r
    drain = parameters["drain_time"]
    front = clamped(history.time, p_f, most * min(1.0, 1.0 - bias), drain)
    return front, clamped(history.time, p_r, most * min(1.0, 1.0 + bias), drain)


def clamped(time: Array, p: Array, most: float, drain: float) -> Array:
    """Clamping pressure max(p, left) [Pa] (n,) with left' = -left/drain, at least min(p, most).

    ``time`` [s], ``p`` [Pa] (n,); ``most`` [Pa], ``drain`` [s]. All samples at once: left
    exp(t/drain) is a running maximum, taken of logarithms so that it does not overflow.
    """
    kept = np.where(p > BITE, np.minimum(p, most), 0.0)
    grown = np.log(np.maximum(kept, 1e-30)) + (time - time[0]) / drain
    left = np.exp(np.maximum.accumulate(grown) - (time - time[0]) / drain)
    return np.where(left > np.maximum(p, 1e-20), left, p)


EFFECT = Effect(
    card=Card(
        name="residual_torque",
        cause="pads that stick: a seized pin or piston, after an application",
        equation=(
            "clamp = max(p, q), q = min(p, r) while applied, q' = -q/T after; front or rear share "
            "by b; no effect at residual_pressure = 0"
        ),
        source="Limpert, Brake Design and Safety, ch. 5; Breuer and Bill, Brake Technology",
        looks_like=(
            "a deceleration that stays after release, with slip of one axle, and none before the "
            "first application; only logs that go on after a release show it"
        ),
        parameters=(
            Parameter("residual_pressure", "Pa", 0.0, 20e5, 1.5e5, 1e5),
            Parameter("drain_time", "s", 1.0, 60.0, 8.0, 5.0),
            Parameter("rear_bias", "1", -1.0, 1.0, 0.0, 0.7),
        ),
    ),
    pressure=pressure,
)
