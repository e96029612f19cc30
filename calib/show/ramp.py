"""The ramps of a calibration as measured points for Fig. 6.

The curves of a table, and so these points, are those of a car without air drag, grade and rolling
resistance. The pads of the table turn pressure into brake forces, and the model of the car without
resistance turns these forces into z, f1 and f2. The eta of a point is the measured eta times the
model's eta without resistance over the model's eta with the resistance of this run.
"""

from dataclasses import dataclass, replace

import numpy as np

from calib.car.balance import front_share, rotating_shares
from calib.car.braking import BITE
from calib.car.forces import paper_curves, speed_ratio
from calib.fitting.ensemble import ensemble_of, loaded_tyres, predict_slips, wheel_slips
from calib.logs.log import Log
from calib.model.ramp import nominal_forces, pad_scale, prepare
from calib.run.resistance import identify as identify_resistance
from calib.run.run import Run
from calib.show.panel import Line
from calib.show.style import REAR, Array, Mask, Stroke
from calib.table.table import Table

_GROUP = 5
"""Blocks per point: in means over 0.25 s the curve shows above the noise of eta."""


@dataclass(frozen=True)
class MeasuredRamp:
    """A ramp in k blocks of 0.05 s, as the car would drive it without resistance.

    Attributes
    ----------
    eta, f1, f2 : as in Fig. 6 [1], (k,) each; NaN where nothing brakes.
    braked : blocks (k,) with enough pressure.
    is_two_axles : whether both axles brake.
    """

    eta: Array
    f1: Array
    f2: Array
    braked: Mask
    is_two_axles: bool


def measure(table: Table, log: Log) -> MeasuredRamp:
    """Return a ramp as points, with the pads and the draws of the posterior of ``table``.

    f1 and f2 come from the pressure and are smooth; eta has the noise of the wheel speeds. Raises
    LogError as `calib.run.run.Run.signals`.
    """
    read = Run(log, table.vehicle)
    car = read.car
    sensor = read.accelerometer(identify_resistance(car, ()))
    run = prepare(read, table.effects.with_(car.effects), sensor)
    b = run.blocks
    nominal = nominal_forces(car, run, table.calibration.pad_log_ratio.value)
    brake = pad_scale(run, *nominal) * np.add(*nominal)
    # the shape discrepancy of a tyre acts alike with resistance and without
    e = ensemble_of(car, replace(table.draws, depart_eta=np.zeros((1, 10))))
    log_ratio, share = e.log_pad_ratio[:, None] + run.log_odds(b.p_f, b.p_r), brake / car.weight
    front = front_share(car, log_ratio)
    moments = np.stack([run.drag_f, run.drag_r])[:, None] / car.weight
    forces = np.stack([front, 1.0 - front]) * share + moments
    _, turning = wheel_slips(e, loaded_tyres(car, e, run.quasi_static(car)).slips(forces))
    eta_model = np.median(speed_ratio(*turning), axis=0)
    unbraked = b.lead_in
    zero = float(np.mean((b.eta / eta_model)[unbraked])) if unbraked.any() else 1.0
    # the same brake forces on the car of the table, which has no resistance
    z_free = np.where(brake > 0.0, share / (1.0 + sum(rotating_shares(car))), np.nan)
    curves = predict_slips(car, e, log_ratio, share, z_free)
    D = np.where(brake > 0.0, np.median(np.subtract(*curves.forces), axis=0), np.nan)
    f1, f2 = paper_curves(car, z_free, D)
    return MeasuredRamp(
        eta=b.eta / zero / eta_model * curves.eta,
        f1=f1,
        f2=f2,
        braked=np.asarray(run.use & ~unbraked & (np.maximum(b.p_f, b.p_r) > BITE)),
        is_two_axles=run.only is None,
    )


def points(ramp: MeasuredRamp, x: Array, y: Array, stroke: Stroke, label: str = "") -> Line:
    """Return points over ``x`` and ``y`` (k,): means of `_GROUP` braked blocks in a row."""
    braked = np.array([x, y])[:, ramp.braked]  # (2, number of braked blocks)
    count = braked.shape[1] // _GROUP  # an incomplete group is left out
    means = braked[:, : count * _GROUP].reshape(2, count, _GROUP).mean(axis=2)
    marker = "^" if stroke is REAR else "o"
    look = {"linestyle": "", "mfc": "white", "ms": 3.4, "mew": 0.8, "zorder": 3}
    return Line(means[0], means[1], {"color": stroke["color"], "marker": marker, **look}, label)
