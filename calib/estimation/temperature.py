"""Pads that depend on nothing but the temperature of the disc: the idea of the paper's [17].

    nominal torque x omega --> temperature of the disc --> nominal pads x fade

Of [17] the paper only says that all heat is absorbed and dissipated by the disc. The law of the
pads is not told; here it is the product's own `pad_thermal_fade` at the typical values of its card:
no change up to 150 degC, then 0.1 % less friction per kelvin. It measures no braking force: on wet
pads it says what nominal pads would do, as the paper says of [17].
"""

import numpy as np
from numpy.typing import NDArray

from calib.base.errors import InputError
from calib.car.disc_temperature import AIR, DISCS, START, disc_temperature
from calib.car.effects import pads
from calib.car.effects.effects import Effects
from calib.car.forces import brake_torque
from calib.car.history import constant_speed
from calib.car.vehicle import Axle, Vehicle
from calib.logs.log import Log
from calib.run.axle_signals import Signals

Array = NDArray[np.float64]
Pair = tuple[Array, Array]

FADE = {p.name: p.typical for p in pads.FADE.card.parameters}
"""Typical thermal fade, from the card of the effect."""


def temperatures(car: Vehicle, log: Log, s: Signals) -> dict[str, Array]:
    """Temperature of a disc of each axle [degC], (n,), by the power of nominal pads; causal.

    A logged `T_disc` gives the first value only: what follows is the model's.
    """
    heat = {}
    for side, axle, pressure, omega in _axles(car, s):
        power = np.abs(brake_torque(axle, axle.pad_friction, pressure) * omega)
        name = f"T_disc_{side}"
        start = float(log[name][0]) if name in log else START
        heat[side] = disc_temperature(s.time, power, DISCS[side], start, AIR)
    return heat


def temperature(car: Vehicle, log: Log, s: Signals, known: Effects) -> Pair:
    """Pad friction of both axles [1], (n,): the nominal one of ``car`` times the fade of its discs.

    Raises InputError if thermal fade is among the ``known`` effects, which are taken out already.
    """
    name = pads.FADE.card.name
    if name in known:
        raise InputError(f"{name} of the car is already taken out of the log")
    history = constant_speed(s.time, log["p_mc"], 0.0, temperatures(car, log, s))
    fade_f, fade_r = pads.faded(FADE, history, s.p_f, s.p_r)
    return car.front.pad_friction * fade_f, car.rear.pad_friction * fade_r


def _axles(car: Vehicle, s: Signals) -> tuple[tuple[str, Axle, Array, Array], ...]:
    """Name, axle, pressure [Pa] and wheel speed [rad/s] of front and rear."""
    return ("f", car.front, s.p_f, s.omega_f), ("r", car.rear, s.p_r, s.omega_r)
