"""Simulate a braking from pressure and first speed: all channels of a log, with their truth.

`simulate` takes a given pressure, `replay` the pressure of a log. `calib.model.solver` solves the
equations of motion. Valid for a straight line and slip on the rising branch of the tyre. Left and
right wheels are equal, and the load transfer has no delay, unless an effect changes that.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from calib.base.arrays import Array, Index
from calib.base.digest import content_digest
from calib.base.errors import LogError, ModelError
from calib.base.names import AXLES, WHEELS, G
from calib.car import forces
from calib.car.brakes import brakes_of
from calib.car.braking import BITE
from calib.car.effects.combined import as_driven, as_read, reading_delay, wheel_speed_factors
from calib.car.history import COLD, Motion, RunHistory, constant_speed
from calib.car.lag import delayed
from calib.car.model import Model
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.model.solver import Drive, SolverState, end_of, history_of, solve
from calib.run.driving_record import SETTLE
from calib.run.pedal import as_pressed

STEP = 0.005
"""Longest step dt of the solver [s]. The solver differentiates wheel speeds backwards, which is
dt/2 late. If the deceleration changes by b, v is then wrong by m b dt/2, where m is the share of
the rotating masses: by 0.0005 m/s for b = 5 m/s^2 and m = 4 %. With dt = 0.025 s it would be
0.0025 m/s, which a noise-free log shows (tests/model/test_replay.py)."""

_FIRST_SECONDS, COAST_SECONDS = 0.25, 1.5
"""Shortest and longest time over which the first speed is fitted by a line [s]. In the shortest a
beginning braking changes v by less than 0.01 m/s, and 0.02 m/s of noise becomes 0.006 m/s; in the
longest drag bends v by 0.001 m/s."""


def simulate(
    model: Model,
    time: Array,
    pressure: Array,
    v0: float,
    *,
    wheel_pressure: Mapping[str, Array] | None = None,
    temperature: Mapping[str, Array] | None = None,
    start_heat: tuple[float, float] = COLD,
    drive_torque: Mapping[str, Array] | None = None,
    wheel_angle: Mapping[str, Array] | None = None,
    stop_speed: float = 1.0,
    name: str = "simulation",
) -> Log:
    """Simulate the model with a given brake pressure. The first sample is a steady state.

    All inputs are (n,) as ``time`` t [s], which increases, and linear between its samples; a clock
    of 40 Hz gives the same run as one of 200 Hz.

    Parameters
    ----------
    model : the car with pads, tyre and effects; `calib.default_model` of a vehicle, or the
        ``model_after`` of a diagnosis.
    pressure, wheel_pressure : at the master cylinder, and of single wheels by name [Pa].
    v0, stop_speed : first speed, and the speed at which the simulation ends [m/s].
    temperature : of the discs [degC] by axle, ``f`` and ``r``. Thermal fade on an axle without one
        takes an assumed disc, heated by its brake.
    start_heat : temperature of the assumed discs at the start [degC], front and rear.
    drive_torque : of engine or motor at both wheels of an axle together [N m], by axle, negative
        where it slows. It adds to the effect ``engine_drag``.
    wheel_angle : of the wheels of an axle [rad], by axle, for effects that ripple with the angle;
        by default the angle of the simulation, from 0 at the first sample.

    The log that is returned has truth channels. It ends with the last sample at or above
    ``stop_speed``, or before a wheel would pass the peak of its tyre or an axle would lift; its
    last note gives the time and the reason. Raises ModelError if nothing can be simulated.

    >>> import numpy as np
    >>> import calib
    >>> car = calib.read_vehicle(calib.sample_logs() / "sedan" / "vehicle.toml")
    >>> time = np.arange(0.0, 4.0, 0.005)
    >>> ramp = np.clip(5e5 * (time - 1.5), 0.0, None)  # 5 bar/s after 1.5 s of rolling
    >>> log = calib.simulate(calib.default_model(car), time, ramp, v0=30.0)
    >>> log.notes
    ('ends at 3.995 s, where its pressure ends',)
    >>> wheel = car.front.torque_gain * car.front.pad_friction * ramp  # (3)
    >>> bool(np.allclose(log.truth["true_Tb_fl"], wheel))
    True
    """
    if not 0.0 < stop_speed < v0 < np.inf:
        expected = f"more than the stop speed, {stop_speed:g} m/s"
        raise ModelError(f"first speed {v0:g} m/s", expected=expected)
    if time.size < 2 or not np.all(np.diff(time) > 0.0):
        raise ModelError("time does not increase", expected="two samples or more, increasing")
    clock, samples = fine_clock(time)
    pedal = _interpolated(time, clock, {"p_mc": pressure}, ("p_mc",))
    p_wheels = _interpolated(time, clock, wheel_pressure, WHEELS)
    discs = _interpolated(time, clock, temperature, AXLES)
    engine = _interpolated(time, clock, drive_torque, AXLES)
    angle = _interpolated(time, clock, wheel_angle, AXLES)
    driven = replace(model, vehicle=as_driven(model.vehicle, model.effects))
    # the history before the speed is solved
    inputs = constant_speed(clock, pedal["p_mc"], v0, discs, name, start_heat)
    no_torque = np.zeros_like(clock)
    torque = (engine.get("f", no_torque), engine.get("r", no_torque))
    run = Drive(brakes_of(driven, inputs, p_wheels), inputs, v0, stop_speed, torque, angle)
    state = solve(run)
    end, note = end_of(run, state)
    places = samples[: np.searchsorted(samples, end)]  # of the given samples in the fine clock
    if places.size < 2:
        raise ModelError("nothing to simulate", expected="two samples or more", do=note)
    history = history_of(run, state)
    recorded = {f"p_{w}": p_wheels[w] for w in WHEELS if w in p_wheels}
    for quantity, by_axle in (("T_disc", discs), ("T_drive", engine)):
        recorded |= {f"{quantity}_{a}": by_axle[a] for a in AXLES if a in by_axle}
    simulated = _channels(run, state, history) | recorded
    channels = {channel: x[places] for channel, x in simulated.items()}
    truth = {channel: x[places] for channel, x in _truth(run, state, history).items()}
    return Log(
        name=name,
        source=f"simulation of {model.vehicle.name}",
        digest=content_digest({"name": name}, {"channels": channels, "truth": truth}),
        channels=channels,
        truth=truth,
        notes=(note,),
    )


def replay(
    model: Model,
    log: Log,
    wheel_angle: Mapping[str, Array] | None = None,
    start_heat: tuple[float, float] = COLD,
) -> Log:
    """Simulate the model with the pressures of a log from its first speed, open loop.

    Wheel pressures, disc temperatures and the torques of engine or motor are used where they are
    logged. ``wheel_angle`` and ``start_heat`` as in `simulate`. Raises LogError if the log has no
    first speed, ModelError if there is nothing to simulate.
    """
    step, car = log.sample_time, as_driven(model.vehicle, model.effects)
    return simulate(
        model,
        log.time,
        as_pressed(log["p_mc"], step),
        first_speed(log, car, reading_delay(model.effects, "speed_delay")),
        wheel_pressure={w: as_pressed(log[f"p_{w}"], step) for w in WHEELS if f"p_{w}" in log},
        temperature={a: log[f"T_disc_{a}"] for a in AXLES if f"T_disc_{a}" in log},
        drive_torque={a: log[f"T_drive_{a}"] for a in AXLES if f"T_drive_{a}" in log},
        wheel_angle=wheel_angle,
        start_heat=start_heat,
        name=log.name,
    )


def first_speed(log: Log, vehicle: Vehicle, delay: float = 0.0) -> float:
    """Speed [m/s] at the first sample, from a straight line through the first samples of ``v``.

    Without ``v`` the line goes through the mean of R omega over the wheels, which is too low by
    their slip if the log begins with braking. The sensor of ``v`` shows the first speed only after
    its ``delay`` [s], so the line is read there. Without ``p_mc`` the log counts as braked from its
    first sample. Raises LogError if there are not two finite samples.
    """
    elapsed = log.time - log.time[0]
    braked = np.flatnonzero(log["p_mc"] > BITE) if "p_mc" in log else np.array([0])
    unbraked = float(elapsed[braked[0]]) - SETTLE if braked.size else np.inf  # [s]
    is_first = elapsed <= min(max(unbraked, _FIRST_SECONDS), COAST_SECONDS)
    measured = log["v"] if "v" in log else _rim_speed(log, vehicle)
    t, speed = elapsed[is_first], measured[is_first]
    is_finite = np.isfinite(speed)
    if np.count_nonzero(is_finite[t <= _FIRST_SECONDS]) < 2:
        flaw = f"no speed in the first {_FIRST_SECONDS:g} s"
        raise LogError(flaw, where=log.source, expected="v, or wheel speeds, from the start")
    line = np.polynomial.Polynomial.fit(t[is_finite], speed[is_finite], 1)
    return float(line(delay))


def _rim_speed(log: Log, vehicle: Vehicle) -> Array:
    """Mean of R omega [m/s] over the wheels that are logged; NaN if none is."""
    radius = {"f": vehicle.front.rolling_radius, "r": vehicle.rear.rolling_radius}
    logged = [w for w in WHEELS if f"omega_{w}" in log]
    speeds = [radius[w[0]] * log[f"omega_{w}"] for w in logged]
    return np.asarray(np.mean(speeds, axis=0) if speeds else np.full(log.time.size, np.nan))


def _interpolated(
    time: Array, clock: Array, inputs: Mapping[str, Array] | None, names: tuple[str, ...]
) -> dict[str, Array]:
    """Interpolate inputs (n,) at ``time`` to the fine ``clock`` (m,), by name.

    Raises ModelError for a name not in ``names``, and for values that are not finite or not (n,).
    """
    interpolated = {}
    for name, values in (inputs or {}).items():
        if name not in names:
            raise ModelError(f"unknown input {name!r}", expected=f"one of {', '.join(names)}")
        if values.shape != time.shape or not np.all(np.isfinite(values)):
            flaw = f"values of shape {values.shape} or not finite"
            raise ModelError(flaw, where=name, expected=f"{time.size} finite samples")
        interpolated[name] = np.interp(clock, time, values)
    return interpolated


def _channels(run: Drive, state: SolverState, history: RunHistory) -> dict[str, Array]:
    """Return the readings of the car's sensors, (m,) each, by channel."""
    model, brakes, effects = run.brakes.model, run.brakes, run.brakes.model.effects
    a_x = as_read(model.vehicle, effects, history, -G * state.z)
    channels = {"time": run.time, "p_mc": run.inputs.p_mc, "a_x": a_x}
    v = run.bounded(state.v)
    motion = Motion(v, *state.loads, history)
    factors = wheel_speed_factors(model.vehicle, effects, motion)
    for w in WHEELS:
        # where left and right are alike, the twin of both was solved
        slip = model.tyre.wheel_slip(state.slip[brakes.twin(w)], v, run.time)
        omega = forces.wheel_speed(brakes.axle(w), slip, state.v)
        omega = delayed(run.time, omega, reading_delay(effects, "wheel_speed_delay"))
        channels[f"omega_{w}"] = omega * factors[w] if w in factors else omega
    return channels | {"v": delayed(run.time, state.v, reading_delay(effects, "speed_delay"))}


def _truth(run: Drive, state: SolverState, history: RunHistory) -> dict[str, Array]:
    """Return the true torques, forces, loads and pads, (m,) each, by channel."""
    twins = {w: run.brakes.twin(w) for w in WHEELS}
    truth = {f"true_Tb_{w}": state.torque[twin] for w, twin in twins.items()}
    truth |= {f"true_Fx_{w}": state.force[twin] for w, twin in twins.items()}
    truth |= {f"true_Fz_{w}": state.load[twin] for w, twin in twins.items()}
    truth["true_mu_pad_f"], truth["true_mu_pad_r"] = run.brakes.pads(history)
    return truth


def fine_clock(time: Array) -> tuple[Array, Index]:
    """Divide each step of an increasing ``time`` [s] (n,) into equal steps of `STEP` at most.

    Return the fine clock [s] (m,), and the indices of the samples of ``time`` in it (n,).
    """
    steps = np.ceil(np.diff(time) / STEP - 1e-6).astype(np.intp)
    places = np.concatenate([[0], np.cumsum(np.maximum(steps, 1))]).astype(np.intp)
    return np.interp(np.arange(places[-1] + 1), places, time), places
