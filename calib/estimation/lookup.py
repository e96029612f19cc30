"""Reading a table: the difference of the normalised forces D from (z, eta), three ways.

`paper` reads f1(eta), f2(eta); `difference` reads D(eta); `tyre` solves the common tyre curve for
the D at which it gives this eta at this z. All three return D and where it is within the table; the
first two know one branch only, the third both.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from calib.car.forces import axle_loads, split
from calib.model.parameters import parameters_of, tyres_of
from calib.run.axle_signals import Signals
from calib.run.filters import low_pass
from calib.table.table import Table

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


STEPS = 4
"""Newton steps of the `tyre` look-up: eta leaves the curve nearly straight in D."""

SETTLED = 1e-3
"""Last step in D [1] beyond which the look-up has not settled; what is left is of its square."""

DRIVEN = -0.05
"""Normalised force [1] below which an axle drives more than coasting wheels can: no braking."""


_SMOOTH = 0.1
"""Time constant of the causal filter on what goes into a look-up [s]: takes road noise out and is
short against the change of a pad."""


class LookupReading(NamedTuple):
    """Normalised forces of the axles [1] and where the table covers them, shapes (n,)."""

    F_f: Array
    F_r: Array
    inside: Mask


def paper(table: Table, z: Array, eta: Array, level: Array) -> LookupReading:
    """F_f = level + f1(eta), F_r = level + f2(eta), (11), (12); ends of the table outside it."""
    c = table.paper
    inside = (eta >= c.eta[0]) & (eta <= c.eta[-1])
    return LookupReading(
        level + np.interp(eta, c.eta, c.f1), level + np.interp(eta, c.eta, c.f2), inside
    )


def difference(table: Table, z: Array, eta: Array, level: Array) -> LookupReading:
    """F_f, F_r from D(eta) under (18) at the live z."""
    c = table.difference
    inside = (eta >= c.eta[0]) & (eta <= c.eta[-1])
    return LookupReading(*split(table.vehicle, z, np.interp(eta, c.eta, c.D), level), inside)


def tyre(table: Table, z: Array, eta: Array, level: Array) -> LookupReading:
    """F_f, F_r from the common tyre curve: D such that the slips give eta, by Newton's method.

    Inside while neither axle passes the greatest force of the curve, drives or lifts off, and the
    steps have settled: they may not on a curve that turns over.
    """
    vehicle = table.vehicle
    tyres = tyres_of(parameters_of(table.posterior))
    curve, apart = tyres.tyre, float(np.exp(0.5 * tyres.log_ratio))
    loads = axle_loads(vehicle, z)
    on_road = np.minimum(*loads) > 0.0
    load_f, load_r = (np.where(on_road, load, 0.5 * vehicle.weight) for load in loads)
    half, rest_f, rest_r = 0.5 * vehicle.weight, *vehicle.static_loads
    gain_f, gain_r = apart * curve.gain(load_f / half), curve.gain(load_r / half) / apart
    # what the radii do to the wheel speeds as they are loaded and relieved
    eta = eta * np.exp(tyres.radius_load * (load_f / rest_f - load_r / rest_r))
    D, step = np.zeros_like(z), np.full_like(z, np.inf)
    for _ in range(STEPS):
        F_f, F_r = split(vehicle, z, D, level)
        slip_f, slip_r = curve.slip_at(F_f, gain_f), curve.slip_at(F_r, gain_r)
        # (22): (1 - slip_r) - eta (1 - slip_f) = 0, and its slope in D
        rest = (1.0 - slip_r) - eta * (1.0 - slip_f)
        slope = (
            curve.slope_at(F_r, gain_r) * load_f + eta * curve.slope_at(F_f, gain_f) * load_r
        ) / (load_f + load_r)
        step = rest / slope
        D = D - step
    F_f, F_r = split(vehicle, z, D, level)
    top = float(table.tyre.force[-1])
    inside = on_road & (F_f <= top) & (F_r <= top) & (np.minimum(F_f, F_r) > DRIVEN)
    return LookupReading(F_f, F_r, inside & (np.abs(step) < SETTLED))


LOOKUPS: dict[str, Callable[[Table, Array, Array, Array], LookupReading]] = {
    "paper": paper,
    "difference": difference,
    "tyre": tyre,
}


def smoothed(s: Signals, x: Array) -> Array:
    """A signal (n,) of a run as it goes into a look-up."""
    return low_pass(x, s.sample_time, _SMOOTH)
