"""The sensor readings that a model predicts, along the measured speed.

    p_mc --> pressures --> torques --> tyre forces --> z --> a_x, v
                                         |
                                         +--> slips --> wheel speeds

It uses the measured speed instead of integrating its own: it does not drift, and a whole run is
computed in array operations.
"""

from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.names import AXLES, WHEELS, G
from calib.car.effects import combined
from calib.car.effects.effects import Effects
from calib.car.forces import axle_loads, brake_torque, deceleration, tyre_force
from calib.car.history import START_TEMP, Motion, RunHistory
from calib.car.lag import delayed, integral
from calib.car.tyre import MagicFormula
from calib.car.vehicle import Vehicle
from calib.diagnosis.explanation.base import FORM_AT, FRONT_HEAT, OWN, REAR_HEAT, SLOPE, ZERO, Base
from calib.diagnosis.explanation.wheel_lag import WheelLag
from calib.logs.log import Log
from calib.run.filters import block_mean, centred_mean, samples_in
from calib.run.pedal import as_pressed

_GRID = 0.01  # clock on which a run is predicted [s]; a disc turns at most 20 times a second
_PASSES = 3  # times that loads, heat and torques are computed from each other
_PASSES_OF_TERM = 8
"""The same where an empirical term goes with the deceleration: each pass leaves up to a quarter of
the error. The first one takes the measured deceleration, so with few passes such a term would
predict a_x from its own noise."""

_EDGE = 0.985  # share of the peak up to which the rising branch is inverted; further it is held


@dataclass(frozen=True, kw_only=True)
class ObservedRun(RunHistory):
    """A log on the grid: means over its steps, shapes (n,), SI.

    As a history: ``v`` without sensor noise, for forces; ``z`` as measured; temperatures smoothed;
    no energy yet; ``source`` its name. Besides, ``step`` of its clock; ``v_read`` the speed as
    measured; ``omega`` (4, n) in the order of `WHEELS`; ``drive`` (2, n) torque of engine or motor
    [N m per axle], zero if not logged; ``random_effects`` (8,) in the order of `OWN`.
    """

    step: float
    v_read: Array
    omega: Array
    drive: Array
    random_effects: Array = field(default_factory=lambda: np.zeros(len(OWN)))

    @property
    def a_x(self) -> Array:
        """Measured acceleration [m/s^2]."""
        return -G * self.z

    def with_random_effects(self, random_effects: Array) -> Self:
        """Return the same with other ``random_effects`` (8,), and with their start heats."""
        front = START_TEMP + float(random_effects[FRONT_HEAT])
        return replace(
            self,
            random_effects=random_effects,
            start_heat=(front, front + float(random_effects[REAR_HEAT])),
        )


@dataclass(frozen=True)
class RunLag:
    """How the wheels of a run follow, with the tyres of that log, behind a ``car`` of no effects.

    Most predictions of a run have the same car and tyres, and it takes a third of their time.
    """

    car: Vehicle
    tyre: MagicFormula
    lag: WheelLag


@dataclass(frozen=True)
class Prediction:
    """``a_x`` [m/s^2], ``gained`` speed since the start [m/s], ``omega`` [rad/s], all as read.

    Of the wheels (4, n) ``use`` the force over the load [1], ``lost`` the part of omega that the
    slip of a tyre without a departure takes [rad/s]; ``lag`` how they follow.
    """

    a_x: Array
    gained: Array
    omega: Array
    use: Array
    lost: Array
    lag: RunLag


def run_of(log: Log) -> ObservedRun:
    """Average a log onto the grid. Raises LogError if it has no reference speed."""
    if "v" not in log:
        raise LogError(
            "no reference speed v",
            where=log.source,
            expected="v [m/s]",
            do="a diagnosis needs it: wheel speeds alone cannot tell slip from speed",
        )
    n = samples_in(_GRID, log.sample_time)
    step = n * log.sample_time

    def smooth(x: Array, seconds: float) -> Array:
        return centred_mean(x, samples_in(seconds, step), held_ends=True)

    means = {name: block_mean(log[name], n) for name in log.channels}
    nothing = np.zeros_like(means["v"])
    heat = {a: smooth(means[f"T_disc_{a}"], 0.5) for a in AXLES if f"T_disc_{a}" in log}
    spun = (0.5 * (log[f"omega_{a}l"] + log[f"omega_{a}r"]) for a in AXLES)
    angle_f, angle_r = (block_mean(integral(log.time, omega), n) for omega in spun)
    return ObservedRun(
        time=means["time"],
        v=smooth(means["v"], 0.1),
        z=deceleration(means["a_x"]),
        p_mc=as_pressed(means["p_mc"], step),
        temperature_f=heat.get("f"),
        temperature_r=heat.get("r"),
        angle_f=angle_f,
        angle_r=angle_r,
        energy_f=nothing,
        energy_r=nothing,
        source=log.name,
        averaged=n,
        step=step,
        v_read=means["v"],
        omega=np.stack([means[f"omega_{w}"] for w in WHEELS]),
        drive=np.stack([means.get(f"T_drive_{a}", nothing) for a in AXLES]),
    )


def _lag_of(car: Vehicle, tyre: MagicFormula, run: ObservedRun) -> RunLag:
    """How the wheels of a run follow, as if both axles used the road as the whole car does."""
    load = np.array(axle_loads(car, run.z))
    _, slope, _ = tyre.slip_at_force(run.z, 2.0 * load / car.weight, _EDGE)
    axles = (car.front, car.rear)
    heavy = np.array([[axle.wheel_inertia / axle.rolling_radius**2] for axle in axles])
    tau = heavy * run.v / (0.5 * load * slope)
    return RunLag(car, tyre, WheelLag.from_tau(tau, tyre.relaxation, run.v, run.step))


def predict(
    vehicle: Vehicle, base: Base, effects: Effects, run: ObservedRun, run_lag: RunLag | None = None
) -> Prediction:
    """Predict a run; ``run_lag`` is how its wheels follow, taken if car and tyres are the same.

    The deceleration acts on the tyre forces through the inertia of the wheels alone, so each pass
    leaves 3 % of its error. Where the second one finds the torques of the first, they depend on
    neither deceleration nor heat, and it is the last one.

    Quantities of the wheels are (s, 2, n), by side and axle; s is 1 where both sides are alike.
    """
    car = replace(combined.as_driven(vehicle, effects).with_radii(base.radius), effects=Effects())
    base = base.of_log(run.random_effects)
    same = run_lag is not None and (run_lag.car, run_lag.tyre) == (car, base.tyre)
    of_run = run_lag if run_lag is not None and same else _lag_of(car, base.tyre, run)
    lag = of_run.lag
    pressed = replace(run, p_mc=np.interp(run.time - base.clock, run.time, run.p_mc))
    lines = combined.line_pressure(effects, pressed)
    clamps = np.array(combined.caliper_pressure(effects, pressed, *lines))
    history, torque = run, np.zeros(0)
    leans = any(term.driver == "deceleration" for term in effects.terms)
    for turn in range(_PASSES_OF_TERM if leans else _PASSES):
        previous, torque = torque, _torque(car, base, effects, history, clamps)
        force, rate, motion, z = _balance(car, effects, history, torque, lag)
        # of one brake of each axle
        energy = np.cumsum(np.mean(torque, axis=0) * run.omega[::2], axis=-1) * run.step
        history = replace(run, z=z, energy_f=energy[0], energy_r=energy[1])
        if turn == 1 and not leans and np.array_equal(previous, torque):
            break
    load = np.maximum(0.5 * np.array([motion.load_f, motion.load_r]), 1.0)
    plain = _slip(car, base.tyre, (force, rate), load, lag)
    use = np.abs(force / load)
    discrepancy = [np.interp(use[:, i], FORM_AT, form) for i, form in enumerate(base.form)]
    slip = plain * (1.0 + np.stack(discrepancy, axis=1))
    late = combined.reading_delay(effects, "wheel_speed_delay")
    slip = np.array([[delayed(run.time, x, late) for x in side] for side in slip])
    gained = integral(run.time, -G * z)
    v_late = combined.reading_delay(effects, "speed_delay")
    shown = delayed(run.time, gained, v_late)  # by v as it is read
    v = run.v_read + (delayed(run.time, gained, late) - shown)  # of the time that the wheels show
    turning = v / np.array([[car.front.rolling_radius], [car.rear.rolling_radius]])
    omega = _by_wheel(turning * (1.0 - slip))
    motion = replace(motion, history=history)
    for w, factor in combined.wheel_speed_factors(car, effects, motion).items():
        omega[WHEELS.index(w)] *= factor
    return Prediction(
        a_x=combined.as_read(car, effects, history, -G * z) + run.random_effects[ZERO],
        gained=shown - G * run.random_effects[SLOPE] * (run.time - run.time[0]),
        omega=omega,
        use=_by_wheel(use),
        lost=_by_wheel(turning * plain),
        lag=of_run,
    )


def _by_wheel(x: Array) -> Array:
    """A quantity (s, 2, n) by side and axle, (4, n) in the order of `WHEELS`."""
    return np.swapaxes(np.broadcast_to(x, (2, *x.shape[1:])), 0, 1).reshape(len(WHEELS), -1)


def _torque(
    car: Vehicle, base: Base, effects: Effects, history: RunHistory, clamps: Array
) -> Array:
    """Brake torque of the wheels [N m] (s, 2, n) at the pressures on their pads [Pa] (2, n)."""
    k_f, k_r = combined.pad_factors(effects, history, *clamps)
    front = brake_torque(car.front, base.pad_friction_f * k_f, clamps[0])
    rear = brake_torque(car.rear, base.pad_friction_r * k_r, clamps[1])
    even, uneven = {"f": front, "r": rear}, combined.wheel_factors(effects, history)
    sides = "lr" if uneven else "l"
    return np.array([[x * uneven.get(a + side, 1.0) for a, x in even.items()] for side in sides])


def _balance(
    car: Vehicle, effects: Effects, history: ObservedRun, torque: Array, lag: WheelLag
) -> tuple[Array, Array, Motion, Array]:
    """Tyre forces [N] and their rates [N/s] (s, 2, n), loads, and z [1], by z of the last pass."""
    late = car.weight * combined.total_load_shift(car, effects, history)
    load_f, load_r = axle_loads(car, history.z)
    motion = Motion(history.v, load_f - late, load_r + late, history)
    moments = 0.5 * (np.array(combined.total_axle_moment(car, effects, motion)) - history.drive)
    steady = [
        tyre_force(axle, torque[:, i], -G * history.z / axle.rolling_radius, moments[i])
        for i, axle in enumerate((car.front, car.rear))
    ]
    force, rate = lag.follow(np.stack(steady, axis=1))
    total = 2.0 * np.sum(np.mean(force, axis=0), axis=0)
    total = total + combined.total_body_force(car, effects, motion)
    return force, rate, motion, total / car.weight


def _slip(
    car: Vehicle, tyre: MagicFormula, force: tuple[Array, Array], load: Array, lag: WheelLag
) -> Array:
    """Slip [1] of wheels while their tyres carry a force [N] that has a rate [N/s]."""
    carried = force[0] / load
    slip, slope, past_edge = tyre.slip_at_force(carried, 4.0 * load / car.weight, _EDGE)
    if tyre.relaxation == 0.0:
        return slip
    change = (force[1] - carried * np.gradient(load, lag.step, axis=-1)) / load
    return slip + np.where(past_edge, 0.0, lag.way * change / slope)
