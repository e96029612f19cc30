"""An `EmpiricalTerm` as an effect, which is simulated, or removed from a log, like all others."""

from collections.abc import Callable

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ModelError
from calib.base.names import AXLE_NAMES
from calib.car.braking import BITE
from calib.car.effects.effect import Card, Effect, Pair, Parameters
from calib.car.effects.effects import EmpiricalTerm
from calib.car.history import Motion, RunHistory
from calib.car.lag import integral
from calib.car.vehicle import Vehicle

PLACES = {
    "front_brakes": "front",
    "rear_brakes": "rear",
    "brakes": "both",
    "front_wheels": "front",
    "rear_wheels": "rear",
    "body": "body",
}
"""Places on which a term can act, and the part of the car there, as in `AXLES_OF`."""

DRIVERS = {
    "pressure": "Pa",
    "speed": "m/s",
    "temperature": "degC",
    "time": "s",
    "deceleration": "1",
    "elapsed": "s",
    "distance": "m",
    "constant": "1",
}
"""Drivers of a term, with their units.

`time` counts from the last moment without braking, `elapsed` and `distance` from the start of the
run. The temperature is that of the discs of an axle in `AXLES_OF`.
"""

AXLES_OF = {"front": "f", "rear": "r", "both": "fr", "body": "f"}
"""Axles whose discs give the temperature of a term, by part of the car. Front discs heat most."""

_CARD = Card(
    name="empirical_term",
    cause="not known",
    equation="linear between knots",
    source="the runs it was fitted to",
    looks_like="the residual of these runs",
    parameters=(),
)


def effect_of(term: EmpiricalTerm) -> Effect:
    """Return the term as an effect without parameters."""
    axles = AXLES_OF[PLACES[term.place]]  # "f", "r" or "fr"; a term on wheels has one axle

    def value_along(history: RunHistory, axle: str) -> Array:
        """Change of pad friction, or force over the weight [1] (n,)."""
        return np.interp(_driver_along(history, term.driver, axle), term.knots, term.values)

    def friction(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
        front = 1.0 + value_along(history, "f") if "f" in axles else np.ones_like(p_f)
        rear = 1.0 + value_along(history, "r") if "r" in axles else np.ones_like(p_r)
        return front, rear

    def body_force(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Array:
        return np.asarray(vehicle.weight * value_along(motion.history, axles))

    def axle_moment(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
        force = vehicle.weight * value_along(motion.history, axles)
        zero = np.zeros_like(force)
        if axles == "f":
            return vehicle.front.rolling_radius * force, zero
        return zero, vehicle.rear.rolling_radius * force

    if term.on_brakes:
        return Effect(_CARD, friction=friction)
    if term.place == "body":
        return Effect(_CARD, body_force=body_force)
    return Effect(_CARD, axle_moment=axle_moment)


def drivers_of(place: str, driver: str, history: RunHistory) -> list[Array]:
    """Values of the ``driver`` of a term on ``place`` along a run, arrays (n,) in its unit.

    The list has one array; for temperatures it has one for each axle of the place. Raises
    ModelError for a temperature that is not known.
    """
    axles = AXLES_OF[PLACES[place]] if driver == "temperature" else "f"
    return [_driver_along(history, driver, axle) for axle in axles]


def _driver_along(history: RunHistory, driver: str, axle: str) -> Array:
    """Values of a driver (n,); only a temperature differs between the axles "f" and "r"."""
    if driver != "temperature":
        return _ALONG[driver](history)
    temperature = history.temperature_f if axle == "f" else history.temperature_r
    if temperature is None:
        flaw = f"no temperature of the {AXLE_NAMES[axle]} discs, on which an empirical term depends"
        expected = f"a channel T_disc_{axle} [degC]"
        do = "log it, or take a model without this term"
        raise ModelError(flaw, where=history.source or None, expected=expected, do=do)
    return temperature


def _since_free(history: RunHistory) -> Array:
    """Time [s] (n,) since the last moment without braking, or since the start of the run."""
    is_braked = history.p_mc > BITE
    last_free = np.maximum.accumulate(np.where(is_braked, history.time[0], history.time))
    return np.asarray(history.time - last_free)


_ALONG: dict[str, Callable[[RunHistory], Array]] = {  # values of each driver but temperature
    "pressure": lambda history: history.p_mc,
    "speed": lambda history: history.v,
    "time": _since_free,
    "deceleration": lambda history: history.z,
    "elapsed": lambda history: np.asarray(history.time - history.time[0]),
    "distance": lambda history: integral(history.time, history.v),
    "constant": lambda history: np.zeros_like(history.v),
}
