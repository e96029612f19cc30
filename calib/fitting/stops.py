"""What a stop may bring, drawn onto an ensemble: the stops of `calib.car.beliefs`."""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.car.beliefs import STOP
from calib.car.mass import WEIGHED
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import Ensemble, Shown, shown, spread_evenly

SCENARIOS = 16384


@dataclass(frozen=True)
class Scenarios:
    """Stops, equally likely, (n,): the car ``of`` each, and what the stop brings.

    ``change`` of ln of the pads' ratio since the ramp; ``peak`` of the road over that of the ramp;
    ``stiff`` ln of the tyres' stiffness of the axles over that of the ramp, (2, n); ``scale`` of
    a_x and pitch, ``offset`` of a_x since the lead-in; ``mass`` ln of the mass over the file's.
    """

    of: Ensemble
    change: Array
    peak: Array
    stiff: Array
    scale: Array
    offset: Array
    mass: Array

    @property
    def log_pad_ratio(self) -> Array:
        """ln of the pads' ratio in the stop, over that of the vehicle file."""
        return self.of.log_pad_ratio + self.change

    def level(self, z: float) -> Array:
        """ln of the brake force over that which ``z`` and the mass of the file give [1]."""
        return np.asarray(np.log(np.maximum(1.0 - self.offset / z, 0.05)) + self.mass)


def scenarios(car: Vehicle, e: Ensemble, count: int = SCENARIOS) -> Scenarios:
    """``count`` stops of the cars of an ensemble, by a fixed sequence.

    Where the file says that the car is weighed, nobody has left a load unstated.
    """
    from scipy.special import ndtri

    u = spread_evenly(count, 11)
    x = ndtri(u)
    of = e.take(np.arange(count) % e.size)
    log_peak = STOP.log_peak.drawn(u[:, 2], x[:, 3])
    stiff = STOP.log_stiffness.drawn(u[:, 2], x[:, 4])
    other = STOP.log_peak.is_case("other road", u[:, 2])  # it has a peak of its own
    log_peak -= other * np.log(of.peak)
    stiff += 0.25 * other * (log_peak + np.log(of.peak / 0.9))
    of_axles = np.stack([STOP.log_tyre.drawn(u[:, 0], x[:, k]) for k in (5, 6)])
    load, known = STOP.log_mass.drawn(u[:, 7], x[:, 8]), car.mass_tolerance
    stated = STOP.log_mass.is_case("as stated", u[:, 7])
    return Scenarios(
        of=of,
        change=STOP.log_pad_ratio.drawn(u[:, 0], x[:, 1]),
        peak=np.exp(log_peak),
        stiff=stiff + of_axles,
        scale=STOP.a_x_scale.drawn(u[:, 7], x[:, 9]),
        offset=STOP.a_x_offset.drawn(u[:, 8], x[:, 10]),
        mass=np.where(stated | (known <= WEIGHED), known * x[:, 8], load),
    )


def seen(car: Vehicle, s: Scenarios, z: Array, odds: Array | float = 0.0) -> Shown:
    """What is seen where the zeroed deceleration demands the brake force ``z`` (k,) [1].

    ``z`` over the weight; ``odds`` (k,) ln of the front pressure over the rear one.
    """
    return shown(
        car,
        s.of,
        s.log_pad_ratio[:, None] + odds,
        (z - s.offset[:, None]) * (1.0 - s.scale[:, None]),
        z,
        peak=s.peak,
        softer=np.exp(-s.stiff)[..., None],
    )
