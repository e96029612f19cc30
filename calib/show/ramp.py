"""The ramps of a calibration as measured points for Fig. 6.

The curves of a table are those of a car without resistance: air drag, grade, rolling resistance.
So are these points. The pads of the table turn pressure into brake forces, and the model of the
car without resistance turns these forces into z, f1 and f2. The eta of a point is

    measured eta * model's eta without resistance / model's eta with the resistance of the run
"""

from dataclasses import dataclass, replace

import numpy as np

from calib.car.balance import front_share, rotating_shares
from calib.car.braking import BITE
from calib.car.forces import paper_curves, speed_ratio
from calib.fitting.ensemble import DEPART_AT, ensemble_of, loaded_tyres, predict_slips, wheel_slips
from calib.logs.log import Log
from calib.model.ramp import nominal_forces, pad_scale, prepare
from calib.run.resistance import identify as identify_resistance
from calib.run.run import Run
from calib.show.panel import Line
from calib.show.style import REAR, Array, Mask, Stroke
from calib.table.table import Table

_GROUP = 5
"""Blocks in a point: a mean over 0.25 s has so little noise of eta that the curve is seen."""


@dataclass(frozen=True)
class MeasuredRamp:
    """A ramp in k blocks of 0.05 s, as the car would drive it without resistance."""

    eta: Array  # as in Fig. 6 [1] (k,), like f1 and f2; NaN where nothing brakes
    f1: Array
    f2: Array
    braked: Mask  # blocks (k,) after the lead-in in which a brake bites
    is_two_axles: bool  # whether both axles brake


def measure(table: Table, log: Log) -> MeasuredRamp:
    """Return a ramp as points, with the pads of ``table`` and its n draws from the posterior.

    f1 and f2 come from the pressure and are smooth; eta has the noise of the wheel speeds. Raises
    LogError as `calib.run.run.Run.signals`.
    """
    read = Run(log, table.vehicle)
    car = read.car
    sensor = read.accelerometer(identify_resistance(car, ()))
    run = prepare(read, table.effects.with_(car.effects), sensor)
    blocks = run.blocks
    nominal_f, nominal_r = nominal_forces(car, run, table.calibration.pad_log_ratio.value)
    brake = pad_scale(run, nominal_f, nominal_r) * (nominal_f + nominal_r)  # both axles [N], (k,)
    share = brake / car.weight  # (k,)
    # the shape discrepancy of eta is the same with resistance and without, and left out here
    no_discrepancy = np.zeros((1, DEPART_AT.size))  # of all draws
    ensemble = ensemble_of(car, replace(table.draws, depart_eta=no_discrepancy))
    log_pressure_ratio = run.log_odds(blocks.p_f, blocks.p_r)  # (k,)
    log_ratio = ensemble.log_pad_ratio[:, None] + log_pressure_ratio  # (n, k)
    # eta of the model with the resistance of this run
    front = front_share(car, log_ratio)
    resistance = np.stack([run.drag_f, run.drag_r])[:, None] / car.weight  # (2, 1, k)
    forces = np.stack([front, 1.0 - front]) * share + resistance  # (2, n, k)
    tyres = loaded_tyres(car, ensemble, run.quasi_static(car))
    unit_slips = tyres.unit_slips(forces)[0]  # slips over the compliance (2, n, k)
    apparent_slips = wheel_slips(ensemble, tyres, unit_slips)[1]  # by the wheel speeds (2, n, k)
    eta_with_resistance = np.median(speed_ratio(*apparent_slips), axis=0)  # (k,)
    unbraked, zero = blocks.lead_in, 1.0
    if unbraked.any():
        zero = float(np.mean((blocks.eta / eta_with_resistance)[unbraked]))
    # z, D and eta of the model without resistance: the same brake force B slows the car and what
    # rotates, B/W = (1 + rotating shares) z
    z = np.where(brake > 0.0, share / (1.0 + sum(rotating_shares(car))), np.nan)
    free = predict_slips(car, ensemble, log_ratio, share, z)
    F_f, F_r = free.forces  # over the axle loads [1], (n, k) each
    D = np.where(brake > 0.0, np.median(F_f - F_r, axis=0), np.nan)
    f1, f2 = paper_curves(car, z, D)
    return MeasuredRamp(
        eta=blocks.eta / zero / eta_with_resistance * free.eta,
        f1=f1,
        f2=f2,
        braked=np.asarray(run.use & ~unbraked & (np.maximum(blocks.p_f, blocks.p_r) > BITE)),
        is_two_axles=run.only is None,
    )


def points(ramp: MeasuredRamp, x: Array, y: Array, stroke: Stroke, label: str = "") -> Line:
    """Return a ramp as points over ``x`` and ``y`` (k,): means of `_GROUP` braked blocks."""
    braked = np.array([x, y])[:, ramp.braked]  # (2, number of braked blocks)
    count = braked.shape[1] // _GROUP  # an incomplete group is left out
    means = braked[:, : count * _GROUP].reshape(2, count, _GROUP).mean(axis=2)
    marker = "^" if stroke is REAR else "o"
    look = {"linestyle": "", "mfc": "white", "ms": 3.4, "mew": 0.8, "zorder": 3}
    return Line(means[0], means[1], {"color": stroke["color"], "marker": marker, **look}, label)
