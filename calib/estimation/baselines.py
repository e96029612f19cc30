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
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import InputError
from calib.car.disc_temperature import AIR, DISCS, START, disc_temperature
from calib.car.effects import pads
from calib.car.effects.effects import Effects
from calib.car.forces import axle_loads, brake_torque
from calib.car.history import constant_speed
from calib.car.vehicle import Vehicle
from calib.estimation.law import Pair, adapted, by_curves, by_map, gain
from calib.logs.log import Log
from calib.run.axle_signals import Signals
from calib.run.brake_response import BrakeBalance
from calib.table.table import Table

_MEMORY = 0.5  # of the mean gain [s]: short against a stop, long against road noise (0.1 s)
_FADE = {p.name: p.typical for p in pads.FADE.card.parameters}


@dataclass(frozen=True)
class BaselineRun:
    """One run as the methods need it.

    ``car`` has the nominal pads; ``known`` its known effects, which are taken out of ``log``;
    ``s`` its signals, ``b`` their balance; ``eta`` zeroed (22) [1], (n,).
    """

    table: Table
    car: Vehicle
    known: Effects
    log: Log
    s: Signals
    b: BrakeBalance
    eta: Array


def baselines(run: BaselineRun, *, laws: bool = True) -> tuple[dict[str, Pair], tuple[str, ...]]:
    """Pad friction (front, rear) [1] (n,) by method, and notes on those that are left out.

    Without ``laws`` only the nominal pads.
    """
    found = {"nominal": _times(run, 1.0, 1.0)}
    notes: dict[str, list[str]] = {}
    for name, method in METHODS.items() if laws else ():
        try:
            found[name] = method(run)
        except InputError as error:
            notes.setdefault(error.what, []).append(name)
    return found, tuple(f"{', '.join(names)} left out: {why}" for why, names in notes.items())


def _times(run: BaselineRun, front: Array | float, rear: Array | float) -> Pair:
    """The nominal pads times factors."""
    one = np.ones_like(run.eta)
    return run.car.front.pad_friction * front * one, run.car.rear.pad_friction * rear * one


def mean_gain(run: BaselineRun) -> Pair:
    """Nominal pads times one factor, the paper's [16].

    Recursive least squares with forgetting over `_MEMORY` of the brake force that the deceleration
    demands over that of nominal pads; 1 before the first braking. Of [16] the paper only says that
    its gain is found recursively and rests on the deceleration of the car alone. Here that is the
    accelerometer's, known resistance taken out. It cannot see a difference between the axles.
    """
    from scipy.signal import lfilter

    u = np.where(run.b.active, run.b.nominal_f + run.b.nominal_r, 0.0)
    pole = [1.0, -float(np.exp(-run.s.sample_time / _MEMORY))]
    above, below = (lfilter([1.0], pole, x) for x in (u * run.b.balance.demanded, u * u))
    factor = np.divide(above, below, out=np.ones_like(u), where=below > 0.0)
    return _times(run, factor, factor)


def temperature(run: BaselineRun) -> Pair:
    """Nominal pads that depend on nothing but the temperature of their discs: the paper's [17].

    Of [17] the paper only says that all heat is absorbed and dissipated by the disc. The law of the
    pads is not told; here it is `pad_thermal_fade` at the typical values of its card: no change up
    to 150 degC, then 0.1 % less friction per kelvin. Heat is that of nominal pads; a logged
    `T_disc` gives the first value only. On wet pads it says what nominal pads would do. Raises
    InputError if thermal fade is a known effect, which is taken out already.
    """
    name = pads.FADE.card.name
    if name in run.known:
        raise InputError(f"{name} of the car is already taken out of the log")
    s, heat = run.s, {}
    for side, axle, pressure, omega in (
        ("f", run.car.front, s.p_f, s.omega_f),
        ("r", run.car.rear, s.p_r, s.omega_r),
    ):
        power = np.abs(brake_torque(axle, axle.pad_friction, pressure) * omega)
        logged = run.log.channels.get(f"T_disc_{side}")
        start = START if logged is None else float(logged[0])
        heat[side] = disc_temperature(s.time, power, DISCS[side], start, AIR)
    history = constant_speed(s.time, run.log["p_mc"], 0.0, heat)
    return _times(run, *pads.faded(_FADE, history, s.p_f, s.p_r))


def as_written(run: BaselineRun) -> Pair:
    """The paper's law (23)-(25) as it is written, with nothing added.

    d omega/dt is the step of the axle's mean wheel speed since the sample before; nothing is
    smoothed. z is the accelerometer's as read, the loads are (6), (7), no resistance or motor is
    taken out, and the law is never frozen. What the paper leaves open: gamma is one for both axles,
    that which gives the front axle `law.RATE`, so that the rear of the reference car is 7 times
    slower; mu_n is that of the estimate; P is the axle's where wheel pressures are logged; eta is
    zeroed like the table's, or both would hold the mismatch of their day's radii.
    """
    car, s = run.car, run.s
    forces, loads = by_curves(run.table, run.eta, s.z), axle_loads(car, s.z)
    out = []
    for axle, pressure, omega, F, load in (
        (car.front, s.p_f, s.omega_f, forces[0], loads[0]),
        (car.rear, s.p_r, s.omega_r, forces[1], loads[1]),
    ):
        spin = np.diff(omega, prepend=omega[0]) / s.sample_time
        road = F * load - 2.0 * axle.wheel_inertia * spin / axle.rolling_radius  # (13), (14)
        out.append(adapted(axle, pressure, road, gain(car.front), s.sample_time))
    return out[0], out[1]


def _plainly(run: BaselineRun, forces: Pair) -> Pair:
    """The law on normalised ``forces``; inertia and resistance by the balance of forces."""
    car, s, b = run.car, run.s, run.b.balance
    of_f = car.front, s.p_f, forces[0] * b.load_f - b.moment_f
    of_r = car.rear, s.p_r, forces[1] * b.load_r - b.moment_r
    front, rear = (adapted(*of, gain(of[0]), s.sample_time, run.b.active) for of in (of_f, of_r))
    return front, rear


METHODS: dict[str, Callable[[BaselineRun], Pair]] = {
    "mean_gain": mean_gain,
    "temperature": temperature,
    "gradient_as_written": as_written,
    "gradient_paper": lambda run: _plainly(
        run, by_curves(run.table, run.eta, run.b.balance.tyre_sum / run.car.weight)
    ),
    "gradient_map": lambda run: _plainly(run, by_map(run.table, run.eta, run.b.balance)),
}
"""The methods beside nominal pads, by the names that they have in files."""
