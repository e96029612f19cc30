"""What an effect is: a card that explains it, and what it adds to one or more links of the chain.

    p_mc -> pressure -> friction -> wheels -> + moment -> tyre -> + body -> mass -> accelerometer
            caliper     pads        L/R       inertia     radius  load_shift         a_x as read

An effect only adds to a link, and has no hook where it does not act. Its parameters are named in
its card and held outside it, in `Effects`, so that one object serves the simulation (which adds
it), the analysis (which takes it out) and the diagnosis (which asks how much of it there is).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.physics.history import Motion, RunHistory
from calib.physics.vehicle import Vehicle

Array = NDArray[np.float64]
Parameters = Mapping[str, float]
Pair = tuple[Array, Array]


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect: SI unit, plausible range, and what to assume when nothing is known.

    ``typical`` and ``spread`` are the mean and one standard deviation over passenger cars, and the
    size at which a diagnosis starts to look for it.
    """

    name: str
    unit: str
    low: float
    high: float
    typical: float
    spread: float


@dataclass(frozen=True)
class Card:
    """What a user reads of an effect.

    The first of ``parameters`` is its strength: at ``neutral`` nothing happens, whatever the
    others are.
    """

    name: str
    cause: str
    equation: str
    source: str
    looks_like: str
    parameters: tuple[Parameter, ...]
    neutral: float = 0.0


@dataclass(frozen=True)
class Effect:
    """A named cause: one hook for each link that it acts on, None for every other link.

    Attributes
    ----------
    card : for the user.
    pressure : pressures of the front and the rear calipers [Pa] from those that arrive; reads only
        ``time`` and ``p_mc`` of the history.
    friction : factors on the pad friction of both axles [1] at the caliper pressures.
    wheels : factors on the brake torque of wheels that differ from the other side [1].
    axle_moment : what slows the wheels besides the brake [N m per axle], positive when it slows.
    inertia : inertia of one wheel beside its own, front and rear [kg m^2].
    radius : factors on the rolling radii [1].
    load_shift : share of W that the front axle lacks against (6), (7) [1].
    body_force : what slows the body directly [N], positive when it slows.
    mass : factor on the mass [1].
    accelerometer : a_x as read from a_x as it is [m/s^2].
    """

    card: Card
    pressure: Callable[[Parameters, RunHistory, Array, Array], Pair] | None = None
    friction: Callable[[Parameters, RunHistory, Array, Array], Pair] | None = None
    wheels: Callable[[Parameters, RunHistory], dict[str, Array]] | None = None
    axle_moment: Callable[[Vehicle, Parameters, Motion], Pair] | None = None
    inertia: Callable[[Parameters], tuple[float, float]] | None = None
    radius: Callable[[Parameters], tuple[float, float]] | None = None
    load_shift: Callable[[Vehicle, Parameters, RunHistory], Array] | None = None
    body_force: Callable[[Vehicle, Parameters, Motion], Array] | None = None
    mass: Callable[[Parameters], float] | None = None
    accelerometer: Callable[[Vehicle, Parameters, RunHistory, Array], Array] | None = None


def acts_on_brakes(effect: Effect) -> bool:
    """Whether an effect changes pressures, pads or the torque of single wheels."""
    return _any(effect.pressure, effect.friction, effect.wheels)


def acts_on_wheels(effect: Effect) -> bool:
    """Whether an effect changes brakes or wheels, not only the body and its sensor."""
    return acts_on_brakes(effect) or _any(effect.axle_moment, effect.inertia, effect.radius)


def slows(effect: Effect) -> bool:
    """Whether an effect slows body or wheels besides the brakes: it is in the force balance."""
    return _any(effect.axle_moment, effect.body_force)


def _any(*hooks: Callable[..., object] | None) -> bool:
    return any(hook is not None for hook in hooks)
