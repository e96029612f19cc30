"""Measured points of a ramp, block by block, for comparison with the curves of its table."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.estimation.plan import known_resistance
from calib.fitting.known_effects import remove_known_effects
from calib.fitting.parameters import parameters_of
from calib.fitting.ramp import normalised_forces, predict, prepare
from calib.fitting.settings import SETTINGS
from calib.logs.log import Log
from calib.names import G
from calib.physics.braking import BITE
from calib.physics.forces import paper_curves
from calib.signals.axle_signals import signals
from calib.signals.blocks import Blocks, blocks
from calib.signals.noise import sensor_noise
from calib.table.table import Table

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

GROUP = 5
"""Blocks per point: a mean over 0.25 s reduces the noise of eta enough to show the curve."""


@dataclass(frozen=True)
class MeasuredRamp:
    """A ramp in blocks, shapes (k,), SI.

    ``time`` [s]; ``pressure`` [Pa]; ``z`` as measured and ``carried``, the part of it that the
    tyres carry [1]; ``eta`` zeroed on the lead-in and ``eta_model``, that of the identified car on
    this run [1]; ``F_f``, ``F_r`` normalised forces from pressure at the table's pads, ``f1``,
    ``f2`` from them [1]; ``slip_f``, ``slip_r`` [1] at the load of the tyre curve, None without v;
    ``braked`` blocks with enough pressure; ``both`` whether both axles brake.
    """

    name: str
    time: Array
    pressure: Array
    z: Array
    carried: Array
    eta: Array
    eta_model: Array
    F_f: Array
    F_r: Array
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
    ran = remove_known_effects(table.vehicle, log)
    vehicle = ran.vehicle
    b = blocks(signals(ran.log, vehicle))
    effects = known_resistance(replace(table, vehicle=vehicle)).effects
    run = prepare(vehicle, log.name, b, sensor_noise(ran.log, b), effects)
    parameters = parameters_of(table.posterior)
    F_f, F_r, _ = normalised_forces(vehicle, run, parameters.log_pad_ratio)
    f1, f2 = paper_curves(vehicle, b.z, F_f - F_r)
    eta_model, _ = predict(vehicle, run, parameters, 0.0, 0.0)
    free = b.lead_in
    # unbraked, F_f and F_r already differ: both carry drag, each its own rolling resistance
    zero = float(np.mean((b.eta / eta_model)[free])) if free.any() else 1.0
    slips = _slips(table, b, run.load_f, run.load_r)
    return MeasuredRamp(
        name=log.name,
        time=b.end,
        pressure=np.maximum(b.p_f, b.p_r),
        z=b.z,
        carried=(run.brake_sum + run.moment_f + run.moment_r) / vehicle.weight,
        eta=b.eta / zero,
        eta_model=eta_model,
        F_f=F_f,
        F_r=F_r,
        f1=f1,
        f2=f2,
        slip_f=slips[0] if slips else None,
        slip_r=slips[1] if slips else None,
        braked=np.asarray(run.use & ~free & (np.maximum(b.p_f, b.p_r) > BITE)),
        both=run.only is None,
    )


def _slips(table: Table, b: Blocks, load_f: Array, load_r: Array) -> tuple[Array, Array] | None:
    """Slips (19), (20) of the axles [1] (k,), converted to the load of the tyre curve."""
    if b.v is None or not b.lead_in.any():
        return None
    posterior = table.posterior
    lag = G * b.z * posterior.value("clock_offset") / np.maximum(b.speed, SETTINGS.min_speed)
    out = []
    for omega, load in ((b.omega_f, load_f), (b.omega_r, load_r)):
        radius = np.mean(b.v[b.lead_in]) / np.mean(omega[b.lead_in])
        softer = (2.0 * load / table.vehicle.weight) ** posterior.value("load_exponent")
        slip = 1.0 - radius * omega / np.maximum(b.v, SETTINGS.min_speed)
        out.append((slip - lag) / softer)
    return out[0], out[1]


def grouped(values: Array, mask: Mask) -> Array:
    """Means of `GROUP` consecutive blocks where ``mask`` is true, without an incomplete group."""
    kept = values[mask]
    count = kept.size // GROUP
    return np.asarray(kept[: count * GROUP].reshape(count, GROUP).mean(axis=1))
