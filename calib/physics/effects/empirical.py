"""An empirical term: what was left, over what it depends on. It is no physics and says so.

A piecewise linear function of one driver that acts on one place of the car. It adds to the same
links as any effect, so that a model with it can be simulated and accounted for.
"""

from dataclasses import dataclass

import numpy as np

from calib.physics.braking import BITE
from calib.physics.effects.effect import Array, Card, Effect, Motion, Pair, Parameters, RunHistory
from calib.physics.vehicle import Vehicle

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
    "constant": "1",
}
"""What a term can depend on, with its unit: time counts from the last bite of the pads, elapsed
from the start of the run, and what is constant has one knot at nought."""


@dataclass(frozen=True)
class Empirical:
    """A term: ``values`` [1] at the ``knots`` of a ``driver``.

    On brakes a value is the factor on the brake torque less one; on wheels and body it is a force
    at the road over the weight, positive when it slows.
    """

    place: str
    driver: str
    knots: tuple[float, ...]
    values: tuple[float, ...]

    @property
    def on_brakes(self) -> bool:
        """Whether it is a factor on a brake torque, not a force at the road."""
        return self.place.endswith("brakes")

    def at(self, trace: RunHistory) -> Array:
        """Value of the term along a run (n,)."""
        return np.interp(driver_along(trace, self.driver), self.knots, self.values)

    def effect(self) -> Effect:
        """The term as an effect without parameters."""
        card = Card(
            name=f"empirical_{self.place}_over_{self.driver}",
            cause="not known",
            equation="piecewise linear over its driver",
            source="the runs it was fitted to",
            looks_like="what was left of them",
            parameters=(),
        )
        if self.on_brakes:
            return Effect(card, friction=self._friction)
        if self.place == "body":
            return Effect(card, body_force=self._body)
        return Effect(card, axle_moment=self._moment)

    def _friction(self, parameters: Parameters, trace: RunHistory, p_f: Array, p_r: Array) -> Pair:
        one, factor = np.ones_like(p_f), 1.0 + self.at(trace)
        if self.place == "brakes":
            return factor, factor
        return (factor, one) if self.place == "front_brakes" else (one, factor)

    def _body(self, vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Array:
        assert motion.trace is not None
        return np.asarray(vehicle.weight * self.at(motion.trace))

    def _moment(self, vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
        force = self._body(vehicle, parameters, motion)
        nothing = np.zeros_like(force)
        if self.place == "front_wheels":
            return vehicle.front.rolling_radius * force, nothing
        return nothing, vehicle.rear.rolling_radius * force


def driver_along(trace: RunHistory, driver: str) -> Array:
    """A driver along a run [SI] (n,); a temperature that is not known counts as nought."""
    if driver == "pressure":
        return trace.p_mc
    if driver == "speed":
        return trace.v
    if driver == "temperature":
        return np.zeros_like(trace.v) if trace.temperature_f is None else trace.temperature_f
    if driver == "deceleration":
        return trace.z
    if driver == "constant":
        return np.zeros_like(trace.v)
    if driver == "elapsed":
        return np.asarray(trace.time - trace.time[0])
    braked = trace.p_mc > BITE
    last_free = np.maximum.accumulate(np.where(braked, -np.inf, trace.time))
    return np.where(np.isfinite(last_free), trace.time - last_free, trace.time - trace.time[0])
