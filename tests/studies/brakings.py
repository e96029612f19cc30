"""The runs of the paired study: pressure, pads and road over time, for any plant to drive.

Ramp and coast; five stops on as many roads, the pads of three of them alike; seven in which
something happens, or happened before.
"""

from dataclasses import dataclass, replace

import numpy as np

from calib.base.arrays import Array
from calib.car.vehicle import Vehicle

G, STEP = 9.80665, 0.005
"""Gravity [m/s^2]; step of all runs [s]."""

Rng = np.random.Generator
Pair = tuple[Array | float, Array | float]

SAME = (1.0, 1.0)
"""Factors on stiffness and peak of the ramp's road."""

ROADS = ("dry", "tile", "basalt", "weak front", "wet")
WITHIN = ("road", "fade", "steps", "step", "short", "rolled", "drift")
"""Another road after 1.5 to 2.5 s; pads from 0.35 to 0.22 in 5 s; pads of 0.25 and 0.33 under steps
of pressure; pads that turn to these within 0.3 s; 0.3 s of rolling before the bite; 300 s of
rolling before it; and 300 s in which the zero of eta drifts by 0.1 %."""
STOPS = ROADS + WITHIN


class BeyondPeakError(ArithmeticError):
    """A stop asks for more force than its road has."""


@dataclass(frozen=True)
class Braking:
    """One run at steps of `STEP`: ``pressure`` (n,) [Pa] from a speed ``v0`` [m/s].

    ``pads`` friction, front and rear, and ``road`` factors on stiffness and peak, each (n,) or one
    [1]; ``alike`` pads changed by one factor since the ramp. Where it rolls for ``rolling`` [s]
    before, the whole run is on the slope that keeps its speed, and the rear radius falls by
    ``drift`` [1], evenly.
    """

    pressure: Array
    v0: float
    pads: Pair
    road: Pair = SAME
    alike: bool = True
    rolling: float = 0.0
    drift: float = 0.0

    @property
    def time(self) -> Array:
        """(n,) [s]."""
        return STEP * np.arange(self.pressure.size)


@dataclass(frozen=True)
class Demand:
    """What a deceleration asks of a car's pedal: its file, its true mass [kg], its ramp's pads, the
    ``peak`` of its tyres on the ramp's road [1]."""

    vehicle: Vehicle
    mass: float
    pads: tuple[float, float]
    peak: float

    def pressure(self, z: float, pads: tuple[float, float] | None = None) -> float:
        """Pressure [Pa] that brakes with about ``z`` [1]; with other ``pads`` at the same torque,
        three quarters of it in front."""
        car = self.vehicle
        per_pascal = sum(
            2.0 * axle.torque_gain * mu / axle.rolling_radius
            for axle, mu in zip((car.front, car.rear), self.pads, strict=True)
        )
        usual, now = (0.75 * front + 0.25 * rear for front, rear in (self.pads, pads or self.pads))
        return z * self.mass * G / per_pascal * usual / now


def brakings(demand: Demand, rng: Rng) -> dict[str, Braking]:
    """Ramp, coast and stops of a car by name.

    The ramp rises by 0.12 g/s to three quarters of the peak, 0.72 g at most.
    """
    top = demand.pressure(min(0.75 * demand.peak, 0.72))
    ramp = np.clip((clock(9.0) - 2.0) * demand.pressure(0.12), 0.0, top)
    return {
        "ramp": Braking(ramp, 32.0, demand.pads),
        "coast": Braking(np.zeros(clock(25.0).size), 33.0, demand.pads),
        **on_roads(demand, rng),
        **events(demand, rng),
    }


def on_roads(demand: Demand, rng: Rng) -> dict[str, Braking]:
    """The stops of `ROADS`: a dry one with the ramp's pads; wet tile and the ramp's road with wet
    pads, which lose alike; basalt with pads unlike; front pads that lost 15 %."""
    front, rear = demand.pads
    even = rng.uniform

    def stop(z: float, v0: float, pads: tuple[float, float], road: Pair, alike: bool) -> Braking:
        return Braking(held_pressure(demand.pressure(z, pads)), v0, pads, road, alike)

    def wet(apart: float) -> tuple[float, float]:
        level = even(0.75, 0.9)
        return front * level, rear * level * float(np.exp(rng.normal(0.0, apart)))

    unlike = front * even(0.85, 1.0), rear * even(0.85, 1.1)
    return {
        "dry": stop(0.5, 28.0, demand.pads, (1.05, 1.05), True),
        "tile": stop(0.2, 16.0, wet(0.02), (even(0.45, 0.65), even(0.28, 0.4)), True),
        "basalt": stop(0.35, 22.0, unlike, (even(0.7, 0.85), even(0.5, 0.65)), False),
        "weak front": stop(0.45, 28.0, (0.85 * front, rear), (1.05, 1.05), False),
        "wet": stop(0.4, 25.0, wet(0.03), SAME, True),
    }


def events(demand: Demand, rng: Rng) -> dict[str, Braking]:
    """The stops of `WITHIN`."""
    front, rear = demand.pads
    wet = 0.85 * front, 0.85 * rear
    unlike = 0.25, 0.33
    time = clock(12.0)
    p_wet, p_unlike = demand.pressure(0.4, wet), demand.pressure(0.4, unlike)
    turned = time > rng.uniform(3.0, 4.0)
    other_road = (rng.uniform(0.7, 0.85), rng.uniform(0.5, 0.65))
    road_before, road_after = (SAME, other_road) if rng.random() < 0.5 else (other_road, SAME)
    road = tuple(np.where(turned, b, a) for a, b in zip(road_before, road_after, strict=True))
    fading = np.interp(time, [1.5, 6.5], [0.35, 0.22])
    steps = np.interp(time, [1.5, 1.6, 2.5, 2.6, 3.5, 3.6, 4.8, 4.9, 6.2, 6.3],
                      [0.0, 0.5, 0.5, 0.9, 0.9, 1.25, 1.25, 0.7, 0.7, 1.05])  # fmt: skip
    stepped = tuple(
        np.interp(time, [3.5, 3.8], [a, b]) for a, b in zip(demand.pads, unlike, strict=True)
    )
    rolled = Braking(held_pressure(p_wet, 312.0, 301.5), 25.0, wet, rolling=300.0)
    return {
        "road": Braking(held_pressure(demand.pressure(0.3, wet)), 25.0, wet, road),
        "fade": Braking(held_pressure(demand.pressure(0.45, (0.35, 0.35))), 28.0, (fading, fading)),
        "steps": Braking(steps * p_unlike, 30.0, unlike, alike=False),
        "step": Braking(held_pressure(p_unlike), 28.0, stepped, alike=False),
        "short": Braking(held_pressure(p_wet, start=0.3), 25.0, wet),
        "rolled": rolled,
        "drift": replace(rolled, drift=0.001),
    }


def clock(duration: float) -> Array:
    """Times [s] at steps of `STEP`."""
    return STEP * np.arange(round(duration / STEP))


def held_pressure(pressure: float, duration: float = 12.0, start: float = 1.5) -> Array:
    """A pressure [Pa] held from ``start`` [s] on, where it rises within 0.4 s."""
    return np.clip((clock(duration) - start) / 0.4, 0.0, 1.0) * pressure
