"""Known effects taken out of a log, so that what is left may be called pad friction.

    a_x as read ----------> a_x of the car                       sensor effects undone
    p_mc --line, caliper--> clamp --pads, left/right--> p_w      pressure that does the same on
                                                                 pads without the effects
    mass, radii, inertias as driven                              into the vehicle

What slows the body or the wheels beside the brakes (drag, grade, engine) stays an effect: it takes
its part of the balance of forces. The load transfer that pitch delays is left to the estimator,
which carries it as a state of its own, with the car's pitch mode where that is known.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.errors import ModelError
from calib.logs.log import Log
from calib.names import AXLES, WHEELS, G
from calib.physics.brakes import Brakes, at_rest, brakes_of
from calib.physics.effects.catalogue import as_driven, as_read, effect_named, pad_factors
from calib.physics.effects.effect import (
    RunHistory,
    acts_on_brakes,
    no_force,
    no_moment,
    true_acceleration,
)
from calib.physics.effects.empirical import Empirical
from calib.physics.forces import deceleration
from calib.physics.lag import integral
from calib.physics.model import Model, default_model
from calib.physics.vehicle import Vehicle

Array = NDArray[np.float64]

SETTLED = 1e-9
"""Largest change of a_x [m/s^2] in the last pass."""

PASSES = 50
"""The sensor effects of a car move a_x by a tenth of it at most: a digit a pass."""


@dataclass(frozen=True)
class CorrectedRun:
    """A run as the car without the effects would have given it.

    ``vehicle`` as driven, with those effects left that take part in the balance of forces, drag
    and rolling resistance among them; ``log`` with ``a_x`` of the car, and wheel pressures where an
    effect changed them; ``factor_f``, ``factor_r`` (n,) what the effects do to the pad friction.
    """

    vehicle: Vehicle
    log: Log
    factor_f: Array
    factor_r: Array


def remove_known_effects(
    vehicle: Vehicle, log: Log, empirical: Empirical | None = None
) -> CorrectedRun:
    """Take the known effects of a vehicle, and a term whose cause is not known, out of a log.

    A run without such effects comes back as it is. Causal: no sample depends on a later one.
    Raises ModelError for an effect the catalogue does not know, for a term on body or wheels over
    a temperature (the balance of forces has none), and when a_x cannot be told from its reading.
    """
    _check(empirical)
    told = default_model(vehicle)
    terms = {name: p for name, p in told.effects.items() if not _is_force(name)}
    on_brakes = empirical if empirical is not None and empirical.on_brakes else None
    car = replace(as_driven(vehicle, told.effects), effects=_forces(told))
    ones = np.ones_like(log.time)
    if not terms and on_brakes is None:
        return CorrectedRun(car, log, ones, ones)
    model = replace(told, vehicle=car, effects=terms, empirical=on_brakes)
    trace = _trace(model, log)
    channels = {**log.channels, "a_x": -G * trace.z}
    brakes = _brakes(model, log)
    factors = (ones, ones)
    if _changes_pressure(model):
        trace = _heated(brakes, trace, log)
        torques = brakes.torques(trace)
        for w in WHEELS:
            gain = brakes.axle(w).torque_gain
            pads = model.pad_friction_f if w[0] == "f" else model.pad_friction_r
            channels[f"p_{w}"] = torques[brakes.twin(w)] / (pads * gain)
        clamp = [brakes.clamp[brakes.twin(f"{a}l")] for a in AXLES]
        factors = pad_factors(model.terms, trace, clamp[0], clamp[1])
    notes = (*log.notes, f"known effects taken out: {', '.join(model.terms)}")
    return CorrectedRun(car, replace(log, channels=channels, notes=notes), *factors)


def _check(empirical: Empirical | None) -> None:
    if empirical is None or empirical.on_brakes or empirical.driver != "temperature":
        return
    raise ModelError(
        f"a term on the {empirical.place} over temperature cannot be taken out of a log",
        where="empirical",
        expected="a term on the brakes, or over speed, pressure, deceleration or time",
    )


def _is_force(name: str) -> bool:
    """Whether an effect leaves the log alone: it acts on body or wheels, or is in the vehicle."""
    effect = effect_named(name)
    return not acts_on_brakes(effect) and effect.accelerometer is true_acceleration


def _changes_pressure(model: Model) -> bool:
    return model.empirical is not None or any(
        acts_on_brakes(effect_named(name)) for name in model.effects
    )


def _forces(model: Model) -> dict[str, dict[str, float]]:
    """The effects that slow body or wheels; one may read on the accelerometer, too."""
    effects = {name: effect_named(name) for name in model.effects}
    return {
        name: dict(model.effects[name])
        for name, effect in effects.items()
        if effect.body_force is not no_force or effect.axle_moment is not no_moment
    }


def _trace(model: Model, log: Log) -> RunHistory:
    """The run behind the log, its a_x freed from what the sensor adds; no heat yet."""
    car = model.vehicle
    omega = {a: 0.5 * (log[f"omega_{a}l"] + log[f"omega_{a}r"]) for a in AXLES}
    v = log["v"] if "v" in log else car.rear.rolling_radius * omega["r"]
    heat = {a: log[f"T_disc_{a}"] for a in AXLES if f"T_disc_{a}" in log}
    run = replace(
        at_rest(log.time, log["p_mc"], float(v[0]), heat),
        v=v,
        angle_f=integral(log.time, omega["f"]),
        angle_r=integral(log.time, omega["r"]),
    )
    a_x = log["a_x"]
    for _ in range(PASSES):
        run = replace(run, z=deceleration(a_x))
        off = log["a_x"] - as_read(car, model.terms, run, a_x)
        a_x = a_x + off
        if float(np.max(np.abs(off))) < SETTLED:
            return run
    raise ModelError(
        "the acceleration cannot be told from its reading",
        where=log.source,
        do="check accelerometer_scale and pitch_coupling among the known effects",
    )


def _brakes(model: Model, log: Log) -> Brakes:
    own = {w: log[f"p_{w}"] for w in WHEELS if f"p_{w}" in log}
    return brakes_of(model, at_rest(log.time, log["p_mc"], 0.0), own)


def _heated(brakes: Brakes, trace: RunHistory, log: Log) -> RunHistory:
    """The run with the heat its brakes took; friction and heat depend on each other and settle."""
    for _ in range(3):
        torques = brakes.torques(trace)
        heat = {a: integral(log.time, np.abs(torques[f"{a}l"] * log[f"omega_{a}l"])) for a in AXLES}
        trace = replace(trace, energy_f=heat["f"], energy_r=heat["r"])
    return trace
