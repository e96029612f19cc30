"""Replay of a log with a model: same pressures, first speed and clock."""

from collections.abc import Mapping

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.names import AXLES, WHEELS
from calib.car.braking import BITE
from calib.car.disc_temperature import ALIKE
from calib.car.effects.combined import as_driven, speed_delay
from calib.car.model import Model
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.model.simulate import simulate
from calib.run.driving_record import SETTLE
from calib.run.pedal import as_pressed

_FIRST_SECONDS, COAST_SECONDS = 0.25, 1.5
"""Shortest and longest span [s] of the line for the first speed: it reduces 0.02 m/s of noise to
0.006 m/s, a beginning braking changes v by less than 0.01 m/s, and drag bends it by 0.001 m/s."""


def replay(
    model: Model,
    log: Log,
    stop_speed: float = 1.0,
    wheel_angle: Mapping[str, Array] | None = None,
    start_heat: tuple[float, float] = ALIKE,
) -> Log:
    """Simulate the model with the pressures of a log from its first speed, open loop.

    Wheel pressures [Pa] are used if they are logged, else ``p_mc``; disc temperatures and the
    torque of engine or motor if they are logged; the rest as in `simulate`. Raises LogError if the
    log has no first speed, ModelError if there is nothing to simulate.
    """
    step = log.sample_time
    return simulate(
        model,
        log.time,
        as_pressed(log["p_mc"], step),
        first_speed(log, as_driven(model.vehicle, model.effects), speed_delay(model.effects)),
        wheel_pressure={w: as_pressed(log[f"p_{w}"], step) for w in WHEELS if f"p_{w}" in log},
        temperature={a: log[f"T_disc_{a}"] for a in AXLES if f"T_disc_{a}" in log},
        drive_torque={a: log[f"T_drive_{a}"] for a in AXLES if f"T_drive_{a}" in log},
        wheel_angle=wheel_angle,
        start_heat=start_heat,
        stop_speed=stop_speed,
        name=log.name,
    )


def first_speed(log: Log, vehicle: Vehicle, late: float = 0.0) -> float:
    """Speed [m/s] at the first sample, from a straight line through the first samples of ``v``.

    Without ``v``, through the mean of R omega over the wheels: too low by their slip if the log
    begins with braking. ``late`` [s] is the time by which ``v`` is read late. Raises LogError if
    there are not two finite samples.
    """
    since = log.time - log.time[0]
    braked = np.flatnonzero(log["p_mc"] > BITE) if "p_mc" in log else np.array([0])
    free = float(since[braked[0]]) - SETTLE if braked.size else np.inf
    first = since <= min(max(free, _FIRST_SECONDS), COAST_SECONDS)
    speed = (log["v"] if "v" in log else _rolling_speed(log, vehicle))[first]
    finite = np.isfinite(speed)
    t = since[first]
    if np.count_nonzero(finite[t <= _FIRST_SECONDS]) < 2:
        raise LogError(
            f"no speed in the first {_FIRST_SECONDS:g} s",
            where=log.source,
            expected="v, or wheel speeds, from the start",
        )
    line = np.polynomial.Polynomial.fit(t[finite], speed[finite], 1)
    return float(line(late))


def _rolling_speed(log: Log, vehicle: Vehicle) -> Array:
    """Mean of R omega [m/s] over the wheels that are logged; NaN if none is."""
    axle = {"f": vehicle.front, "r": vehicle.rear}
    logged = [w for w in WHEELS if f"omega_{w}" in log]
    speeds = [axle[w[0]].rolling_radius * log[f"omega_{w}"] for w in logged]
    return np.asarray(np.mean(speeds, axis=0) if speeds else np.full(log.time.size, np.nan))
