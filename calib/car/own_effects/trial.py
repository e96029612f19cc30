"""A made run on which the hooks of an effect of the user's own are tried before they are used."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.base.names import G
from calib.car.effects.effect import Array
from calib.car.forces import axle_loads
from calib.car.history import Motion, RunHistory
from calib.car.vehicle import Axle, Vehicle

CAR = Vehicle(
    name="trial",
    mass=1744.0,
    cg_to_front_axle=1.1556,
    cg_to_rear_axle=1.6494,
    cg_height=0.615,
    track_width=1.55,
    front=Axle(0.322, 1.2, 28.84e-4, 0.1309, 2, 0.38),
    rear=Axle(0.322, 1.1, 11.34e-4, 0.124, 2, 0.38),
)
"""Tables I and II of the paper."""

SAMPLES = 400
STEP = 0.01
"""Clock of the run [s]."""

FACTORS = ("friction", "wheels", "radius", "wheel_speed", "mass")
"""Hooks that return factors: a link does not change at one, and else at zero."""

TOLERANCE = 1e-9
"""Largest change, relative to one or to the value itself, that counts as rounding."""


def trial(hook: str, parameters: Mapping[str, float]) -> tuple[Any, ...]:
    """What a hook is called with: braking from 30 m/s to a stand, released at 3 s; read-only."""
    history = _history()
    load_f, load_r = axle_loads(CAR, history.z)
    motion = Motion(history.v, _fixed(load_f), _fixed(load_r), history)
    own = dict(parameters)
    if hook in ("pressure", "friction"):
        return own, history, history.p_mc, _fixed(0.8 * history.p_mc)
    if hook in ("axle_moment", "body_force", "wheel_speed"):
        return CAR, own, motion
    if hook == "accelerometer":
        return CAR, own, history, _fixed(-G * history.z)
    if hook == "load_shift":
        return CAR, own, history
    return (own, history) if hook == "wheels" else (own,)


def changes(hook: str, given: tuple[Any, ...], result: Any) -> bool:
    """Whether the ``result`` of a hook changes the link on which it acts."""
    if hook == "pressure":
        return any(_differs(p, before) for p, before in zip(result, given[2:], strict=True))
    if hook == "accelerometer":
        return _differs(result, given[3])
    nothing = 1.0 if hook in FACTORS else 0.0
    values = result.values() if isinstance(result, Mapping) else result
    several = isinstance(result, Mapping | tuple)
    return any(_differs(v, nothing) for v in (values if several else (result,)))


def _differs(value: Array | float, nothing: Array | float) -> bool:
    return not np.allclose(value, nothing, rtol=TOLERANCE, atol=TOLERANCE)


def _history() -> RunHistory:
    time: Array = _fixed(np.arange(SAMPLES) * STEP)
    v: Array = 30.0 - 7.5 * time
    angle = np.cumsum(v) * STEP / CAR.front.rolling_radius
    held = np.clip(time - 0.5, 0.0, 1.0) - np.clip(4.0 * (time - 3.0), 0.0, 1.0)
    pressed = 40e5 * held + 1e3 * np.sin(50.0 * time)  # below zero at first, as a noisy sensor
    return RunHistory(
        time=time,
        v=_fixed(v),
        z=_fixed(0.018e-5 * pressed),
        p_mc=_fixed(pressed),
        temperature_f=_fixed(150.0 + 60.0 * time),
        temperature_r=_fixed(90.0 + 30.0 * time),
        angle_f=_fixed(angle),
        angle_r=_fixed(angle),
        energy_f=_fixed(60e3 * time),
        energy_r=_fixed(20e3 * time),
        source="trial",
    )


def _fixed(values: NDArray[Any]) -> Array:
    """A copy that cannot be changed in place."""
    out = np.array(values, dtype=np.float64)
    out.flags.writeable = False
    return out
