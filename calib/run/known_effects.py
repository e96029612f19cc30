"""Remove known effects from a log: the run as the car without the effects would have given it.

    a_x, omega as read --> a_x, omega of the car              effects on sensors are undone
    p_mc --> clamping --> torque --> wheel pressures          that would make the same torque
                                                              without effects on the brakes
    mass, radii, inertias as driven --> vehicle

Whatever else slows body or wheels (drag, grade, engine) or moves load (pitch) stays in the balance
of forces, where a fit and an estimate account for it (`calib.estimation.known`). So does a logged
torque of engine or motor: with ``engine_drag`` beside such a log the same torque counts twice.
"""

from dataclasses import dataclass, replace

import numpy as np

from calib.base.arrays import Array, Index
from calib.base.errors import ModelError
from calib.base.names import AXLES, WHEELS, G
from calib.car.brakes import brakes_of
from calib.car.braking import MOVING
from calib.car.effects import combined
from calib.car.effects.combined import on_links, reading_delay
from calib.car.effects.effect import BALANCE, BRAKES, READINGS
from calib.car.effects.effects import Effects
from calib.car.forces import axle_loads, deceleration
from calib.car.history import Motion, RunHistory, constant_speed
from calib.car.lag import delayed, integral
from calib.car.model import Model, default_model
from calib.car.vehicle import Vehicle
from calib.logs.log import Log

_TOLERANCE = 1e-9  # largest change of a_x [m/s^2] in the last iteration
_ITERATIONS = 50  # most iterations to the true a_x; each gains a digit, or more
_HEAT_ITERATIONS = 3  # friction and heat depend on each other; three are enough even for wet pads


@dataclass(frozen=True)
class CorrectedRun:
    """A run as the car would have given it without the effects."""

    vehicle: Vehicle  # as driven; of its effects only those on the balance of forces are left
    log: Log  # with the true a_x, and wheel pressures if an effect on the brakes is known
    factor_f: Array  # factor (n,) by which the effects change the pad friction
    factor_r: Array

    def take(self, rows: Index) -> "CorrectedRun":
        """Return the samples at ``rows`` alone."""
        channels = {name: x[rows] for name, x in self.log.channels.items()}
        log = replace(self.log, channels=channels)
        return CorrectedRun(self.vehicle, log, self.factor_f[rows], self.factor_r[rows])


def remove_known_effects(vehicle: Vehicle, log: Log) -> CorrectedRun:
    """Remove the known effects of a vehicle, empirical terms included, from a log.

    An ECU can do so, unless the pressure is logged late (a negative ``hydraulic_delay``). Raises
    ModelError for an unknown effect, a term on the brakes over a temperature that the log lacks, a
    term on body or wheels over temperature, and an a_x that cannot be computed from its reading.
    """
    full_model = default_model(vehicle)
    for term in full_model.effects.terms:
        if term.driver == "temperature" and not term.on_brakes:
            raise ModelError(
                f"a term on the {term.place} over temperature cannot be taken out of a log",
                where=log.source,
                expected="a term on the brakes, or over speed, pressure, deceleration or time",
            )
    driven = combined.as_driven(vehicle, full_model.effects)
    car = replace(driven, effects=on_links(full_model.effects, BALANCE))
    effects = on_links(full_model.effects, (*BRAKES, *READINGS))
    ones = np.ones_like(log.time)
    if not effects:
        return CorrectedRun(car, log, ones, ones)
    model = replace(full_model, vehicle=car, effects=effects)
    history = _true_motion(model, log)
    channels = {**log.channels, "a_x": -G * history.z, **_speeds_in_time(effects, log, history)}
    motion = Motion(history.v, *axle_loads(car, history.z), history)
    for w, factor in combined.wheel_speed_factors(car, effects, motion).items():
        channels[f"omega_{w}"] = channels[f"omega_{w}"] / factor
    factors = (ones, ones)
    if on_links(effects, BRAKES):
        pressures, factors = _without_brake_effects(model, log, history)
        channels |= pressures
    notes = (*log.notes, f"known effects taken out: {', '.join(effects.described)}")
    return CorrectedRun(car, replace(log, channels=channels, notes=notes), *factors)


def _without_brake_effects(
    model: Model, log: Log, history: RunHistory
) -> tuple[dict[str, Array], tuple[Array, Array]]:
    """Wheel pressures that make the same torques without effects; factors of the pad friction."""
    logged = {w: log[f"p_{w}"] for w in WHEELS if f"p_{w}" in log}
    pedal = constant_speed(log.time, log["p_mc"], 0.0, source=log.source)  # for its pressure alone
    brakes = brakes_of(model, pedal, logged)
    torques = brakes.torques(history)
    for _ in range(_HEAT_ITERATIONS):
        powers = (np.abs(torques[f"{a}l"] * log[f"omega_{a}l"]) for a in AXLES)
        energy_f, energy_r = (integral(log.time, power) for power in powers)  # [J]
        history = replace(history, energy_f=energy_f, energy_r=energy_r)
        torques = brakes.torques(history)
    pads = {"f": model.pad_friction_f, "r": model.pad_friction_r}
    pressures = {  # where left and right are alike, one is computed: the twin of both
        f"p_{w}": torques[brakes.twin(w)] / (pads[w[0]] * brakes.axle(w).torque_gain)
        for w in WHEELS
    }
    clamp_f, clamp_r = (brakes.clamp[brakes.twin(f"{a}l")] for a in AXLES)
    return pressures, combined.pad_factors(model.effects, history, clamp_f, clamp_r)


def _true_motion(model: Model, log: Log) -> RunHistory:
    """Motion of the car, with the errors of the accelerometer undone by iteration.

    Friction heat is computed later; disc temperatures are those that are logged.
    """
    car = model.vehicle
    omega = {a: 0.5 * (log[f"omega_{a}l"] + log[f"omega_{a}r"]) for a in AXLES}
    v = log["v"] if "v" in log else car.rear.rolling_radius * omega["r"]
    temperatures = {a: log[f"T_disc_{a}"] for a in AXLES if f"T_disc_{a}" in log}
    run = replace(
        constant_speed(log.time, log["p_mc"], float(v[0]), temperatures, log.source),
        v=v,
        angle_f=integral(log.time, omega["f"]),
        angle_r=integral(log.time, omega["r"]),
    )
    # invert a first-order accelerometer; a second order would matter little and add noise
    rise = np.diff(log["a_x"], prepend=log["a_x"][0]) / np.gradient(log.time)
    a_x = reading = log["a_x"] + combined.accelerometer_lag(model.effects) * rise
    for _ in range(_ITERATIONS):
        run = replace(run, z=deceleration(a_x))
        excess = reading - combined.as_sensed(car, model.effects, run, a_x)
        a_x = a_x + excess
        if float(np.max(np.abs(excess))) < _TOLERANCE:
            return run
    raise ModelError(
        "the acceleration cannot be computed from its reading",
        where=log.source,
        do="check accelerometer_scale and pitch_coupling among the known effects",
    )


def _speeds_in_time(effects: Effects, log: Log, history: RunHistory) -> dict[str, Array]:
    """Speeds whose delay is known, corrected by the change of v in that time, at constant slip."""
    gained = integral(log.time, -G * history.z)
    v_delay = reading_delay(effects, "speed_delay")
    omega_delay = reading_delay(effects, "wheel_speed_delay")
    in_time = {}
    v = history.v
    if "v" in log and v_delay:
        v = in_time["v"] = log["v"] + (gained - delayed(log.time, gained, v_delay))
    if omega_delay:
        change = gained - delayed(log.time, gained, omega_delay)
        # without a logged v, v was computed from the late wheels, so it is the earlier one
        earlier_v = v - change if "v" in log else v
        ratio = 1.0 + change / np.maximum(earlier_v, MOVING)
        in_time |= {f"omega_{w}": log[f"omega_{w}"] * ratio for w in WHEELS}
    return in_time
