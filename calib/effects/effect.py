"""What an effect is: a card that explains it, and the forces it adds.

An effect only adds. Its parameters are named in its card and held outside it, so that one object
serves the simulation (which adds it), the analysis (which accounts for it) and the report.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.vehicle import Vehicle

Array = NDArray[np.float64]
Parameters = Mapping[str, float]


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect: SI unit, plausible range, and what to assume when nothing is known.

    ``typical`` and ``spread`` are the mean and one standard deviation over passenger cars.
    """

    name: str
    unit: str
    low: float
    high: float
    typical: float
    spread: float


@dataclass(frozen=True)
class Card:
    """What a user reads of an effect."""

    name: str
    cause: str
    equation: str
    source: str
    looks_like: str
    parameters: tuple[Parameter, ...]


@dataclass(frozen=True)
class Motion:
    """The state an effect may depend on; arrays of one shape.

    ``v`` [m/s]; ``load_f``, ``load_r`` axle loads [N].
    """

    v: Array
    load_f: Array
    load_r: Array


def no_force(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Array:
    """Nothing on the body [N]."""
    return np.zeros_like(motion.v)


def no_moment(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> tuple[Array, Array]:
    """Nothing on the wheels [N m]."""
    return np.zeros_like(motion.v), np.zeros_like(motion.v)


@dataclass(frozen=True)
class Effect:
    """A named cause.

    ``body_force`` gives what slows the body directly [N]; ``axle_moment`` what slows the wheels of
    the front and of the rear axle besides the brake [N m per axle]. Both positive when they slow.
    """

    card: Card
    body_force: Callable[[Vehicle, Parameters, Motion], Array] = no_force
    axle_moment: Callable[[Vehicle, Parameters, Motion], tuple[Array, Array]] = no_moment
