"""Other ways to the pad friction, shown beside the estimate: the paper's, and what it argues with.

    nominal               the pads of the file
    mean_gain             one factor for both axles by recursive least squares, the paper's [16]
    temperature           nominal pads that fade with a computed disc temperature, its [17]
    gradient_as_written   the paper's law (23)-(25) on f1(eta), f2(eta), as it is written
    gradient_paper        on the same curves with a gain for each axle, known resistance taken out
    gradient_map          the same with f1, f2 read from the map

The curves hold on the road of the ramp: what they cost on another one is the difference of the last
two. A method that cannot be used on a run is left out, with a note; none stops an estimate.
"""

from collections.abc import Callable

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.errors import InputError
from calib.car.balance import ForceBalance, force_balance
from calib.car.disc_temperature import AIR, DISCS, START, disc_temperature
from calib.car.effects import pads
from calib.car.effects.effect import Pair
from calib.car.effects.effects import Effects
from calib.car.forces import brake_torque
from calib.car.history import constant_speed
from calib.estimation.estimator import Estimate
from calib.estimation.law import adapted, by_curves, by_map, gain

_MEMORY = 0.5  # of the mean gain [s]: short against a stop, long against road noise (0.1 s)
_FADE = {p.name: p.typical for p in pads.FADE.card.parameters}


def other_methods(e: Estimate) -> tuple[dict[str, Pair], tuple[str, ...]]:
    """Pad friction (front, rear) [1] (n,) by method, and notes on those that are left out."""
    found: dict[str, Pair] = {}
    notes: dict[str, list[str]] = {}
    for name, method in METHODS.items():
        try:
            found[name] = method(e)
        except InputError as error:
            notes.setdefault(error.what, []).append(name)
    return found, tuple(f"{', '.join(names)} left out: {why}" for why, names in notes.items())


def nominal(e: Estimate, front: Array | float = 1.0, rear: Array | float = 1.0) -> Pair:
    """The nominal pads, times factors."""
    one = np.ones_like(e.read.time)
    return e.car.front.pad_friction * front * one, e.car.rear.pad_friction * rear * one


def mean_gain(e: Estimate) -> Pair:
    """Nominal pads times one factor, the paper's [16].

    Recursive least squares with forgetting over `_MEMORY` of the brake force that the deceleration
    demands over that of nominal pads; 1 before the first braking. Of [16] the paper only says that
    its gain is found recursively and rests on the deceleration of the car alone. Here that is the
    accelerometer's, known resistance taken out. It cannot see a difference between the axles.
    """
    from scipy.signal import lfilter

    u = np.where(e.forces.active, e.forces.nominal_f + e.forces.nominal_r, 0.0)
    pole = [1.0, -float(np.exp(-e.read.sample_time / _MEMORY))]
    above, below = (lfilter([1.0], pole, x) for x in (u * e.forces.balance.demanded, u * u))
    factor = np.divide(above, below, out=np.ones_like(u), where=below > 0.0)
    return nominal(e, factor, factor)


def temperature(e: Estimate) -> Pair:
    """Nominal pads that depend on nothing but the temperature of their discs: the paper's [17].

    Of [17] the paper only says that all heat is absorbed and dissipated by the disc. The law of the
    pads is not told; here it is `pad_thermal_fade` at the typical values of its card: no change up
    to 150 degC, then 0.1 % less friction per kelvin. Heat is that of nominal pads; a logged
    `T_disc` gives the first value only. On wet pads it says what nominal pads would do. Raises
    InputError if thermal fade is a known effect, which is taken out already.
    """
    name = pads.FADE.card.name
    if name in e.car.effects:
        raise InputError(f"{name} of the car is already taken out of the log")
    s, heat = e.read, {}
    for side, axle, pressure, omega in (
        ("f", e.car.front, s.p_f, s.omega_f),
        ("r", e.car.rear, s.p_r, s.omega_r),
    ):
        power = np.abs(brake_torque(axle, axle.pad_friction, pressure) * omega)
        logged = e.ran.log.channels.get(f"T_disc_{side}")
        start = START if logged is None else float(logged[0])
        heat[side] = disc_temperature(s.time, power, DISCS[side], start, AIR)
    history = constant_speed(s.time, s.p_f, 0.0, heat)
    return nominal(e, *pads.faded(_FADE, history, s.p_f, s.p_r))


def as_written(e: Estimate) -> Pair:
    """The paper's law (23)-(25) as it is written, with nothing added.

    d omega/dt is the step of the axle's mean wheel speed since the sample before; nothing is
    smoothed. z is the accelerometer's as read, the loads are (6), (7), no resistance or motor is
    taken out, and the law is never frozen. What the paper leaves open: gamma is one for both axles,
    that which gives the front axle `law.RATE`, so that the rear of the reference car is 7 times
    slower; mu_n is that of the estimate; P is the axle's where wheel pressures are logged; eta is
    zeroed like the table's, or both would hold the mismatch of their day's radii.
    """
    car, s = e.car, e.read
    spin_f, spin_r = (np.diff(x, prepend=x[0]) / s.sample_time for x in (s.omega_f, s.omega_r))
    b = force_balance(car, Effects(), s.time, s.speed, s.z, s.p_f, spin=(spin_f, spin_r))
    gamma = gain(car.front)
    return _adapted(e, b, by_curves(e.table, e.eta, s.z), (gamma, gamma))


def _plainly(e: Estimate, forces: Pair) -> Pair:
    """The law with a gain for each axle, known resistance taken out, frozen where no pads bite."""
    gammas = gain(e.car.front), gain(e.car.rear)
    return _adapted(e, e.forces.balance, forces, gammas, e.forces.active)


def _adapted(
    e: Estimate,
    b: ForceBalance,
    forces: Pair,
    gammas: tuple[float, float],
    acts: Mask | bool = True,
) -> Pair:
    """The law on normalised ``forces`` of the axles [1], with loads and moments of a balance."""
    s, front, rear = e.read, e.car.front, e.car.rear
    of_f, of_r = forces[0] * b.load_f - b.moment_f, forces[1] * b.load_r - b.moment_r  # (13), (14)
    return (
        adapted(front, s.p_f, of_f, gammas[0], s.sample_time, acts),
        adapted(rear, s.p_r, of_r, gammas[1], s.sample_time, acts),
    )


METHODS: dict[str, Callable[[Estimate], Pair]] = {
    "nominal": nominal,
    "mean_gain": mean_gain,
    "temperature": temperature,
    "gradient_as_written": as_written,
    "gradient_paper": lambda e: _plainly(
        e, by_curves(e.table, e.eta, e.forces.balance.tyre_sum / e.car.weight)
    ),
    "gradient_map": lambda e: _plainly(e, by_map(e.table, e.eta, e.forces.balance)),
}
"""The methods by the names that they have in files."""
