"""Empirical terms as effects: simulated and removed from a log as those of the catalogue."""

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
"""Places a term can act on, and the axle they belong to."""

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
"""Drivers of a term, with their units. `time` counts from the last brake application, `elapsed` and
`distance` from the start of the run; the temperature is that of the axle's discs."""

DISCS = {"front": "f", "rear": "r", "both": "fr", "body": "f"}
"""Axles whose disc temperatures a term uses; the front discs take most heat."""


def effect_of(term: EmpiricalTerm) -> Effect:
    """The term as an effect without parameters."""
    card = Card(
        f"empirical_{term.place}_over_{term.driver}",
        cause="not known",
        equation="piecewise linear over its driver",
        source="the runs it was fitted to",
        looks_like="the residual of these runs",
        parameters=(),
    )

    def value(history: RunHistory, axle: str) -> Array:
        return np.interp(_driver_along(history, term.driver, axle), term.knots, term.values)

    def friction(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
        front, rear = (
            1.0 + value(history, axle) if axle in DISCS[PLACES[term.place]] else np.ones_like(p)
            for axle, p in (("f", p_f), ("r", p_r))
        )
        return front, rear

    def body_force(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Array:
        return np.asarray(vehicle.weight * value(motion.history, "f"))

    def axle_moment(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
        axle = DISCS[PLACES[term.place]]
        force = vehicle.weight * value(motion.history, axle)
        nothing = np.zeros_like(force)
        if axle == "f":
            return vehicle.front.rolling_radius * force, nothing
        return nothing, vehicle.rear.rolling_radius * force

    if term.on_brakes:
        return Effect(card, friction=friction)
    if term.place == "body":
        return Effect(card, body_force=body_force)
    return Effect(card, axle_moment=axle_moment)


def drivers_of(place: str, driver: str, history: RunHistory) -> list[Array]:
    """Driver of a term on ``place`` [SI], arrays (n,): one, or of each axle its temperature.

    Raises ModelError where a temperature is not known.
    """
    axles = DISCS[PLACES[place]] if driver == "temperature" else "f"
    return [_driver_along(history, driver, axle) for axle in axles]


def _driver_along(history: RunHistory, driver: str, axle: str) -> Array:
    """A driver along a run [SI] (n,). Raises ModelError for a temperature that is not known."""
    if driver != "temperature":
        return _ALONG[driver](history)
    temperature = history.temperature_f if axle == "f" else history.temperature_r
    if temperature is None:
        raise ModelError(
            f"no temperature of the {AXLE_NAMES[axle]} discs, on which an empirical term depends",
            where=history.source or None,
            expected=f"a channel T_disc_{axle} [degC]",
            do="log it, or take a model without this term",
        )
    return temperature


def _since_free(history: RunHistory) -> Array:
    """Time since the brake was free last [s], or since the start."""
    braked = history.p_mc > BITE
    free = np.maximum.accumulate(np.where(braked, history.time[0], history.time))
    return np.asarray(history.time - free)


_ALONG: dict[str, Callable[[RunHistory], Array]] = {
    "pressure": lambda history: history.p_mc,
    "speed": lambda history: history.v,
    "time": _since_free,
    "deceleration": lambda history: history.z,
    "elapsed": lambda history: np.asarray(history.time - history.time[0]),
    "distance": lambda history: integral(history.time, history.v),
    "constant": lambda history: np.zeros_like(history.v),
}
