"""What an effect is: a card that explains it, and what it adds to one or more links of the chain.

    p_mc -> pressure -> friction -> wheels -> + moment -> tyre -> + body -> mass -> accelerometer
            caliper     pads        L/R       inertia     radius  load_shift         a_x as read

An effect only adds to a link, and leaves alone what it does not name. Its parameters are named in
its card and held outside it, so that one object serves the simulation (which adds it), the analysis
(which accounts for it) and the diagnosis (which asks how much of it there is).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
class RunHistory:
    """A run over time, for effects that remember; arrays (n,), SI.

    ``time`` [s], increasing; ``v`` [m/s]; ``z`` deceleration over g [1]; ``p_mc`` [Pa];
    ``temperature_f``, ``temperature_r`` of the discs [degC], None where not known; ``angle_f``,
    ``angle_r`` wheel angle since the first sample [rad]; ``energy_f``, ``energy_r`` dissipated in
    one brake of the axle since the first sample [J].
    """

    time: Array
    v: Array
    z: Array
    p_mc: Array
    temperature_f: Array | None
    temperature_r: Array | None
    angle_f: Array
    angle_r: Array
    energy_f: Array
    energy_r: Array


@dataclass(frozen=True)
class Motion:
    """The state an effect may depend on; arrays of one shape.

    ``v`` [m/s]; ``load_f``, ``load_r`` axle loads [N]; ``trace`` the run behind it, where known.
    """

    v: Array
    load_f: Array
    load_r: Array
    trace: RunHistory | None = None


def no_force(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Array:
    """Nothing on the body [N]."""
    return np.zeros_like(motion.v)


def no_moment(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
    """Nothing on the wheels [N m]."""
    return np.zeros_like(motion.v), np.zeros_like(motion.v)


def same_pressure(parameters: Parameters, trace: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Caliper pressures [Pa] as they come."""
    return p_f, p_r


def same_friction(parameters: Parameters, trace: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factors one on the pads [1]."""
    one = np.ones_like(p_f)
    return one, one


def same_wheels(parameters: Parameters, trace: RunHistory) -> dict[str, Array]:
    """No wheel's brake torque differs from that of the other side; only such wheels are named."""
    return {}


def no_inertia(parameters: Parameters) -> tuple[float, float]:
    """No inertia beside the wheels', front and rear, per wheel [kg m^2]."""
    return 0.0, 0.0


def same_mass(parameters: Parameters) -> float:
    """Factor one on the mass [1]."""
    return 1.0


def same_radius(parameters: Parameters) -> tuple[float, float]:
    """Factors one on the rolling radii, front and rear [1]."""
    return 1.0, 1.0


def no_shift(vehicle: Vehicle, parameters: Parameters, trace: RunHistory) -> Array:
    """Nothing of the load transfer is late: share of W that the front axle still lacks [1]."""
    return np.zeros_like(trace.z)


def true_acceleration(
    vehicle: Vehicle, parameters: Parameters, trace: RunHistory, a_x: Array
) -> Array:
    """The accelerometer reads what there is [m/s^2]."""
    return a_x


@dataclass(frozen=True)
class Effect:
    """A named cause.

    Attributes
    ----------
    card : for the user.
    pressure : pressures of the front and the rear calipers [Pa] from those that arrive; reads only
        ``time`` and ``p_mc`` of the trace.
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
    pressure: Callable[[Parameters, RunHistory, Array, Array], Pair] = same_pressure
    friction: Callable[[Parameters, RunHistory, Array, Array], Pair] = same_friction
    wheels: Callable[[Parameters, RunHistory], dict[str, Array]] = same_wheels
    axle_moment: Callable[[Vehicle, Parameters, Motion], Pair] = no_moment
    inertia: Callable[[Parameters], tuple[float, float]] = no_inertia
    radius: Callable[[Parameters], tuple[float, float]] = same_radius
    load_shift: Callable[[Vehicle, Parameters, RunHistory], Array] = no_shift
    body_force: Callable[[Vehicle, Parameters, Motion], Array] = no_force
    mass: Callable[[Parameters], float] = same_mass
    accelerometer: Callable[[Vehicle, Parameters, RunHistory, Array], Array] = true_acceleration


def acts_on_brakes(effect: Effect) -> bool:
    """Whether an effect changes pressures, pads or the torque of single wheels."""
    return not (
        effect.pressure is same_pressure
        and effect.friction is same_friction
        and effect.wheels is same_wheels
    )


def acts_on_wheels(effect: Effect) -> bool:
    """Whether an effect changes brakes or wheels, not only the body and its sensor."""
    return acts_on_brakes(effect) or not (
        effect.axle_moment is no_moment
        and effect.inertia is no_inertia
        and effect.radius is same_radius
    )
