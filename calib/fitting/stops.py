"""What a stop may bring, drawn onto an ensemble: the stops of `calib.car.beliefs`.

Each quantity has random numbers of its own, by its name: they hang neither on the order of the rows
nor on how many there are. Only the road of a stop decides two things, its peak and its stiffness.
"""

from dataclasses import dataclass
from zlib import crc32

import numpy as np

from calib.base.arrays import Array
from calib.base.names import AXLES
from calib.car.beliefs import STOP, Mixture
from calib.car.vehicle import WEIGHED, Vehicle
from calib.fitting.ensemble import Ensemble, Shown, shown, spread_evenly

SCENARIOS = 16384
_EVEN = (
    *("log_pad_ratio case", "log_pad_ratio", "road", "log_peak", "log_stiffness", "log_tyre_f"),
    *("log_tyre_r", "log_mass case", "log_mass", "a_x_scale", "a_x_offset"),
)
"""What is spread evenly together: each name has its dimension, and a table rests on its place."""
_ROADS = [dict(zip(of.cases, of.share, strict=True)) for of in (STOP.log_peak, STOP.log_stiffness)]
if _ROADS[0] != _ROADS[1]:
    raise ValueError(f"peak and stiffness are of the same roads, as often: {_ROADS}")


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

    even = dict(zip(_EVEN, spread_evenly(count, len(_EVEN)).T, strict=True))

    def uniform(name: str) -> Array:
        return even[name] if name in even else _in_any_order(count, name)

    def drawn(name: str, case: str = "", axle: str = "") -> Array:
        of: Mixture = getattr(STOP, name)
        return of.drawn(uniform(case or f"{name}{axle} case"), ndtri(uniform(name + axle)))

    of = e.take(np.arange(count) % e.size)
    log_peak, stiff = (drawn(name, "road") for name in ("log_peak", "log_stiffness"))
    other = STOP.log_peak.is_case("other road", uniform("road"))  # it has a peak of its own
    log_peak -= other * np.log(of.peak)
    stiff += 0.25 * other * (log_peak + np.log(of.peak / 0.9))
    stated = STOP.log_mass.is_case("as stated", uniform("log_mass case"))
    mass = car.mass_tolerance * ndtri(uniform("log_mass"))
    return Scenarios(
        of=of,
        change=drawn("log_pad_ratio"),
        peak=np.exp(log_peak),
        stiff=stiff + np.stack([drawn("log_tyre", axle=f"_{axle}") for axle in AXLES]),
        scale=drawn("a_x_scale"),
        offset=drawn("a_x_offset"),
        mass=np.where(stated | (car.mass_tolerance <= WEIGHED), mass, drawn("log_mass")),
    )


def _in_any_order(count: int, name: str) -> Array:
    """Uniform numbers (count,) of a ``name``: the middles of as many steps, in its own order."""
    order = np.random.default_rng(crc32(name.encode())).permutation(count)
    return np.asarray((order + 0.5) / count)


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
