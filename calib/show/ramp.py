"""The ramp of a calibration: forces (Fig. 5), and points for Figs. 3 and 6.

The curves of a table over eta are those of a car without air drag, grade and rolling resistance. So
are the points that are compared with them:

    p --pads--> brake forces --the car without resistance--> z, D, f1, f2, and its eta
    eta as measured, over that of the identified car on this run, times its eta without resistance
"""

from dataclasses import dataclass

import numpy as np

from calib.base.names import G
from calib.car.balance import moment_at_road
from calib.car.braking import BITE
from calib.car.forces import axle_loads, paper_curves, speed_ratio
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.model.parameters import RampParameters, parameters_of, tyres_of
from calib.model.ramp import (
    RampRun,
    nominal_forces,
    normalised_forces,
    predict,
    prepare,
)
from calib.model.settings import SETTINGS
from calib.run.resistance import identify as identify_resistance
from calib.run.run import Run
from calib.show.panel import Line, Panel
from calib.show.style import BODY, FRONT, MEAN, REAR, Array, Mask, Stroke
from calib.table.table import Table

_GROUP = 5
"""Blocks per point: a mean over 0.25 s reduces the noise of eta enough to show the curve."""


@dataclass(frozen=True)
class MeasuredRamp:
    """A ramp in blocks, shapes (k,).

    As driven: ``time`` [s]; ``z`` [1]; ``F_f``, ``F_r`` normalised forces from pressure at the
    table's pads [1]; ``slip_f``, ``slip_r`` [1] at the load of the tyre curve, None without v.

    As the table has it, without resistance: ``z_free``, ``eta``, ``D``, ``f1``, ``f2`` [1], NaN
    where nothing brakes.

    ``braked`` blocks with enough pressure; ``both`` whether both axles brake.
    """

    name: str
    time: Array
    z: Array
    F_f: Array
    F_r: Array
    z_free: Array
    eta: Array
    D: Array
    f1: Array
    f2: Array
    slip_f: Array | None
    slip_r: Array | None
    braked: Mask
    both: bool


def measure(table: Table, log: Log) -> MeasuredRamp:
    """Evaluate a ramp with the pads, the resistance and the load exponent of ``table``.

    The forces are smooth, the noise is in eta and slip. Raises LogError as `signals` does.
    """
    read = Run(log, table.vehicle)
    vehicle = read.car
    sensor = read.accelerometer(identify_resistance(vehicle, ()))
    run = prepare(read, table.effects.with_(vehicle.effects), sensor)
    b = run.blocks
    parameters = parameters_of(table.posterior)
    F_f, F_r, scale = normalised_forces(vehicle, run, parameters.log_pad_ratio)
    eta_model, _ = predict(vehicle, run, parameters)
    free = b.lead_in
    # unbraked, F_f and F_r already differ: both carry drag, each its own rolling resistance
    zero = float(np.mean((b.eta / eta_model)[free])) if free.any() else 1.0
    # the same brake forces on the car of the table, which has no resistance
    B_f, B_r = (scale * B for B in nominal_forces(vehicle, run, parameters.log_pad_ratio))
    B_f, B_r = (np.where(B_f + B_r > 0.0, B, np.nan) for B in (B_f, B_r))
    z_free, D, eta_free = _without_resistance(vehicle, parameters, B_f, B_r)
    f1, f2 = paper_curves(vehicle, z_free, D)
    slips = _slips(table, parameters, run, F_f, F_r)
    return MeasuredRamp(
        name=log.name,
        time=b.end,
        z=read.blocks.z,
        F_f=F_f,
        F_r=F_r,
        z_free=z_free,
        eta=b.eta / zero / eta_model * eta_free,
        D=D,
        f1=f1,
        f2=f2,
        slip_f=slips[0] if slips else None,
        slip_r=slips[1] if slips else None,
        braked=np.asarray(run.use & ~free & (np.maximum(b.p_f, b.p_r) > BITE)),
        both=run.only is None,
    )


def _without_resistance(
    vehicle: Vehicle, parameters: RampParameters[float], B_f: Array, B_r: Array
) -> tuple[Array, Array, Array]:
    """z, D and eta [1] of a car that nothing slows but brake forces [N], (k,) each."""
    rates = [-G / axle.rolling_radius for axle in (vehicle.front, vehicle.rear)]
    wheels_f, wheels_r = (
        moment_at_road(axle, 0.0, np.asarray(rate))
        for axle, rate in zip((vehicle.front, vehicle.rear), rates, strict=True)
    )
    z = (B_f + B_r) / (vehicle.weight - wheels_f - wheels_r)
    loads = axle_loads(vehicle, z)
    F_f, F_r = (B_f + wheels_f * z) / loads[0], (B_r + wheels_r * z) / loads[1]
    slips = tyres_of(parameters).slips((F_f, F_r), loads, vehicle.static_loads)
    return z, F_f - F_r, speed_ratio(*slips)


def _slips(
    table: Table, parameters: RampParameters[float], run: RampRun, F_f: Array, F_r: Array
) -> tuple[Array, Array] | None:
    """Slips (19), (20) of the axles [1] (k,), converted to the load of the tyre curve.

    The lead-in gives the radii: there a wheel has the slip of what slows it besides the brake.
    """
    b, static = run.blocks, table.vehicle.static_loads
    if b.v is None or not b.lead_in.any():
        return None
    loads, tyres = (run.load_f, run.load_r), tyres_of(parameters)
    lag = G * b.z * parameters.clock_offset / np.maximum(b.speed, SETTINGS.min_speed)
    rolling = tyres.slips((F_f, F_r), loads, static)
    shown = []
    for omega, model in zip((b.omega_f, b.omega_r), rolling, strict=True):
        rim_speed = np.mean(b.v[b.lead_in]) * (1.0 - np.mean(model[b.lead_in]))
        radius = rim_speed / np.mean(omega[b.lead_in])
        shown.append(1.0 - radius * omega / np.maximum(b.v, SETTINGS.min_speed) - lag)
    return tyres.on_the_curve((shown[0], shown[1]), loads, static)


def points(ramp: MeasuredRamp, x: Array, y: Array, stroke: Stroke, label: str = "") -> Line:
    """Braked blocks as means of `_GROUP` consecutive ones; an incomplete group is left out."""
    kept = np.array([x, y])[:, ramp.braked]
    count = kept.shape[1] // _GROUP
    at = kept[:, : count * _GROUP].reshape(2, count, _GROUP).mean(axis=2)
    marker = "^" if stroke is REAR else "o"
    look = {"linestyle": "", "mfc": "white", "ms": 3.4, "mew": 0.8, "zorder": 3}
    return Line(at[0], at[1], {"color": stroke["color"], "marker": marker, **look}, label)


def panel(ramp: MeasuredRamp, name: str) -> Panel:
    """Fig. 5: the forces of a ramp over time; z is between them, but for the drag of the air."""
    lines = (
        Line(ramp.time, ramp.F_f, FRONT, "front", mean=MEAN),
        Line(ramp.time, ramp.F_r, REAR, "rear", mean=MEAN),
        Line(ramp.time, ramp.z, BODY, "deceleration over g", mean=MEAN),
    )
    title = f"Force over load in {ramp.name} (Fig. 5)"
    return Panel(name, title, "time [s]", "force over load [1]", lines)
