"""The sensor readings that a model predicts, along the measured speed.

    p_mc --> pressures --> torques --> tyre forces --> z --> a_x, v
                                         |
                                         +--> slips --> wheel speeds

The measured speed is used instead of an integrated speed, which would drift and would need a loop
over time. `run_of` averages a log onto a grid, `predict` predicts its readings.
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
from calib.diagnosis.explanation import unknowns
from calib.diagnosis.explanation.unknowns import DISCREPANCY_FORCES, RANDOM_EFFECTS, Base
from calib.diagnosis.explanation.wheel_lag import WheelLag
from calib.logs.log import Log
from calib.run.filters import block_mean, centred_mean, samples_in
from calib.run.pedal import as_pressed

_GRID = 0.01  # clock on which a run is predicted [s]; a disc turns at most 20 times a second
_PASSES = 3  # times that loads, heat and torques are computed from each other
_PASSES_OF_TERM = 8
"""Passes if an empirical term depends on the deceleration: each leaves up to a quarter of the
error. The first pass takes the measured deceleration, so after few passes such a term would predict
a_x from the noise of a_x."""
_EDGE = 0.985  # share of the tyre's peak above which a larger force gives no larger slip


@dataclass(frozen=True, kw_only=True)
class ObservedRun(RunHistory):
    """A log on the grid: means over the steps of the grid, shapes (n,), SI.

    ``v`` and temperatures of `RunHistory` are smoothed, ``z`` is measured, energies are zero.
    """

    step: float  # of the grid [s]
    v_read: Array  # speed as measured
    omega: Array  # (4, n), in the order of `WHEELS`
    drive: Array  # torque of engine or motor at each axle, zero if not logged (2, n)
    random_effects: Array = field(default_factory=lambda: np.zeros(len(RANDOM_EFFECTS)))  # (8,)

    @property
    def a_x(self) -> Array:
        """Measured acceleration [m/s^2]."""
        return -G * self.z

    def with_random_effects(self, random_effects: Array) -> Self:
        """Return the run with other ``random_effects`` (8,), and with the start heats by them."""
        front = START_TEMP + float(random_effects[unknowns.FRONT_HEAT])
        return replace(
            self,
            random_effects=random_effects,
            start_heat=(front, front + float(random_effects[unknowns.REAR_HEAT])),
        )


@dataclass(frozen=True)
class RunLag:
    """Lag of the wheels of a run, reused in further predictions: it takes a third of their time."""

    car: Vehicle  # without effects
    tyre: MagicFormula  # on the road of the log
    lag: WheelLag


@dataclass(frozen=True)
class Prediction:
    """Readings of the sensors, and what they follow from."""

    a_x: Array  # [m/s^2] (n,)
    speed_gain: Array  # of v since the start [m/s] (n,)
    omega: Array  # [rad/s] (4, n)
    normalised_force: Array  # of each wheel [1] (4, n)
    slip_speed: Array  # what slip, without discrepancy, takes from omega [rad/s] (4, n)
    lag: RunLag


def run_of(log: Log) -> ObservedRun:
    """Average a log onto the grid. Raises LogError if the log has no reference speed."""
    if "v" not in log:
        do = "a diagnosis needs it: wheel speeds alone cannot tell slip from speed"
        raise LogError("no reference speed v", where=log.source, expected="v [m/s]", do=do)
    n = samples_in(_GRID, log.sample_time)
    step = n * log.sample_time

    def smooth(x: Array, seconds: float) -> Array:
        return centred_mean(x, samples_in(seconds, step), held_ends=True)

    means = {name: block_mean(log[name], n) for name in log.channels}
    zero = np.zeros_like(means["v"])
    heat = {a: smooth(means[f"T_disc_{a}"], 0.5) for a in AXLES if f"T_disc_{a}" in log}
    axle_speeds = (0.5 * (log[f"omega_{a}l"] + log[f"omega_{a}r"]) for a in AXLES)
    angle_f, angle_r = (block_mean(integral(log.time, omega), n) for omega in axle_speeds)
    return ObservedRun(
        time=means["time"],
        v=smooth(means["v"], 0.1),
        z=deceleration(means["a_x"]),
        p_mc=as_pressed(means["p_mc"], step),
        temperature_f=heat.get("f"),
        temperature_r=heat.get("r"),
        angle_f=angle_f,
        angle_r=angle_r,
        energy_f=zero,
        energy_r=zero,
        source=log.name,
        averaged=n,
        step=step,
        v_read=means["v"],
        omega=np.stack([means[f"omega_{w}"] for w in WHEELS]),
        drive=np.stack([means.get(f"T_drive_{a}", zero) for a in AXLES]),
    )


def predict(
    vehicle: Vehicle, base: Base, effects: Effects, run: ObservedRun, run_lag: RunLag | None = None
) -> Prediction:
    """Predict the readings of a run; ``run_lag`` is used if it is that of the same car and tyre.

    The deceleration acts on the tyre forces through the inertia of the wheels alone, so each pass
    leaves 3 % of the error of z. If the second pass gives the same torques as the first, torques
    depend on neither z nor heat, and no third pass is needed.

    Quantities of the wheels are (s, 2, n), by side and axle; s is 1 where both sides are alike.
    """
    car = replace(combined.as_driven(vehicle, effects).with_radii(base.radius), effects=Effects())
    base = base.of_log(run.random_effects)
    if run_lag is None or (run_lag.car, run_lag.tyre) != (car, base.tyre):
        run_lag = _lag_of(car, base.tyre, run)
    # with the pressure on the clock of the other channels
    on_one_clock = replace(run, p_mc=np.interp(run.time - base.clock, run.time, run.p_mc))
    lines = combined.line_pressure(effects, on_one_clock)
    clamps = np.array(combined.caliper_pressure(effects, on_one_clock, *lines))
    history, torque = run, np.zeros(0)
    depends_on_z = any(term.driver == "deceleration" for term in effects.terms)
    for number in range(_PASSES_OF_TERM if depends_on_z else _PASSES):
        previous, torque = torque, _torque(car, base, effects, history, clamps)
        force, rate, motion, z = _balance(car, effects, history, torque, run_lag.lag)
        # heat of one brake of each axle, (2, n), by the speeds of the left wheels
        energy = np.cumsum(np.mean(torque, axis=0) * run.omega[::2], axis=-1) * run.step
        history = replace(run, z=z, energy_f=energy[0], energy_r=energy[1])
        if number == 1 and not depends_on_z and np.array_equal(previous, torque):
            break
    load = np.maximum(0.5 * np.array([motion.load_f, motion.load_r]), 1.0)
    formula_slip = _slip(car, base.tyre, (force, rate), load, run_lag.lag)
    normalised_force = np.abs(force / load)
    discrepancy = [  # (2, s, n)
        np.interp(normalised_force[:, i], DISCREPANCY_FORCES, values)
        for i, values in enumerate(base.discrepancy)
    ]
    slip = formula_slip * (1.0 + np.stack(discrepancy, axis=1))
    wheel_delay = combined.reading_delay(effects, "wheel_speed_delay")
    slip = np.array([[delayed(run.time, x, wheel_delay) for x in side] for side in slip])
    gain = integral(run.time, -G * z)  # of the true speed since the start
    gain_read = delayed(run.time, gain, combined.reading_delay(effects, "speed_delay"))
    gain_at_wheels = delayed(run.time, gain, wheel_delay)
    v = run.v_read + (gain_at_wheels - gain_read)  # at the moment that the wheel speeds show
    rolling = v / np.array([[car.front.rolling_radius], [car.rear.rolling_radius]])
    omega = _by_wheel(rolling * (1.0 - slip))
    motion = replace(motion, history=history)
    for w, factor in combined.wheel_speed_factors(car, effects, motion).items():
        omega[WHEELS.index(w)] *= factor
    return Prediction(
        a_x=combined.as_read(car, effects, history, -G * z) + run.random_effects[unknowns.ZERO],
        speed_gain=gain_read - G * run.random_effects[unknowns.SLOPE] * (run.time - run.time[0]),
        omega=omega,
        normalised_force=_by_wheel(normalised_force),
        slip_speed=_by_wheel(rolling * formula_slip),
        lag=run_lag,
    )


def _lag_of(car: Vehicle, tyre: MagicFormula, run: ObservedRun) -> RunLag:
    """Lag of the wheels of a run, with tyre slopes at a normalised force of z on both axles."""
    axle_load = np.array(axle_loads(car, run.z))  # (2, n)
    load_ratio = 2.0 * axle_load / car.weight  # of a wheel, over a quarter of the weight
    _, slope, _ = tyre.slip_at_force(run.z, load_ratio, _EDGE)
    axles = (car.front, car.rear)
    rim_mass = np.array([[axle.wheel_inertia / axle.rolling_radius**2] for axle in axles])  # J/R^2
    tau = rim_mass * run.v / (0.5 * axle_load * slope)  # a wheel has half the load of its axle
    return RunLag(car, tyre, WheelLag.from_tau(tau, tyre.relaxation, run.v, run.step))


def _by_wheel(x: Array) -> Array:
    """A quantity (s, 2, n) by side and axle as (4, n), in the order of `WHEELS`."""
    return np.swapaxes(np.broadcast_to(x, (2, *x.shape[1:])), 0, 1).reshape(len(WHEELS), -1)


def _torque(
    car: Vehicle, base: Base, effects: Effects, history: RunHistory, clamps: Array
) -> Array:
    """Brake torque of the wheels [N m] (s, 2, n) at the pressures on their pads [Pa] (2, n)."""
    factor_f, factor_r = combined.pad_factors(effects, history, *clamps)
    front = brake_torque(car.front, base.pad_friction_f * factor_f, clamps[0])
    rear = brake_torque(car.rear, base.pad_friction_r * factor_r, clamps[1])
    factors = combined.wheel_factors(effects, history)  # of the wheels that differ from their axle
    if not factors:
        return np.array([[front, rear]])
    return np.array(
        [[front * factors.get(f"f{s}", 1.0), rear * factors.get(f"r{s}", 1.0)] for s in "lr"]
    )


def _balance(
    car: Vehicle, effects: Effects, history: ObservedRun, torque: Array, lag: WheelLag
) -> tuple[Array, Array, Motion, Array]:
    """Tyre forces [N] and rates [N/s] (s, 2, n), motion with loads at ``history.z``, the new z."""
    load_shift = car.weight * combined.total_load_shift(car, effects, history)
    load_f, load_r = axle_loads(car, history.z)
    motion = Motion(history.v, load_f - load_shift, load_r + load_shift, history)
    # what slows a wheel besides its brake [N m], (2, n)
    moments = 0.5 * (np.array(combined.total_axle_moment(car, effects, motion)) - history.drive)
    steady = [
        tyre_force(axle, torque[:, i], -G * history.z / axle.rolling_radius, moments[i])
        for i, axle in enumerate((car.front, car.rear))
    ]
    force, rate = lag.follow(np.stack(steady, axis=1))
    total = 2.0 * np.sum(np.mean(force, axis=0), axis=0)  # two wheels on each axle
    total = total + combined.total_body_force(car, effects, motion)
    return force, rate, motion, total / car.weight


def _slip(
    car: Vehicle, tyre: MagicFormula, force: tuple[Array, Array], load: Array, lag: WheelLag
) -> Array:
    """Slip [1] of wheels whose tyres have a ``force`` [N] and its rate [N/s], and a load [N]."""
    normalised = force[0] / load
    load_ratio = 4.0 * load / car.weight  # over a quarter of the weight
    slip, slope, past_edge = tyre.slip_at_force(normalised, load_ratio, _EDGE)
    if tyre.relaxation == 0.0:
        return slip
    # the slip of a tyre with a relaxation length leads the force
    change = (force[1] - normalised * np.gradient(load, lag.step, axis=-1)) / load  # [1/s]
    return slip + np.where(past_edge, 0.0, lag.relaxation_time * change / slope)
