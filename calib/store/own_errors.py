r"""Errors of a table that its own run made, apart from those that all cars of a line share.

    own      noise, zeros              another run of the same car draws them anew
    shared   mass, resistance,         vehicle file, track, kind of sensor, method: alike in all
             accelerometer, tyres,     cars of a line, so that a mean of cars keeps them
             load_geometry, unlike_pads

What of the shared ones is not alike (a driver's weight, one car's accelerometer) differs from car
to car and is seen there: it counts as spread between cars. A table without a budget does not say
what is its own; nothing of it is then.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from calib.fitting.path import delta_sigma, path
from calib.model.parameters import RampParameters, tyres_of
from calib.model.settings import SETTINGS
from calib.table.table import Array, Table

OWN = ("noise", "zeros")
"""Parts of `calib.table.budget` that differ from run to run and cannot be alike in two cars."""

RATIO, COMPLIANCE = "log_pad_ratio", "log_compliance"


def stiffness(table: Table) -> float:
    """Logarithm of the slip stiffness of the tyres [1]."""
    return -table.posterior.value(COMPLIANCE)


def own_covariance(table: Table) -> Array:
    """Covariance of the posterior (k, k) by the errors of the table's own run."""
    n = len(table.posterior.names)
    parts = {} if table.budget is None else table.budget.posterior
    return sum((np.asarray(parts[p]) for p in OWN if p in parts), np.zeros((n, n)))


def own_variance(table: Table, name: str) -> float:
    """Variance of a parameter by the errors of the table's own run; 0 for one that it lacks."""
    names = table.posterior.names
    return float(own_covariance(table)[(names.index(name),) * 2]) if name in names else 0.0


def own_level(table: Table) -> float:
    """Variance of the logarithm of the pad level [1] by the errors of the table's own run."""
    level = {} if table.budget is None else table.budget.level
    return sum(level.get(part, 0.0) for part in OWN)


def own_share(table: Table, eta: Array) -> Array:
    """Share of the own errors in the variance of D at ``eta`` (n,), 0 to 1, by the delta method."""
    z = np.linspace(0.0, table.paper.decelerations[1], SETTINGS.rows)

    def D(x: RampParameters[float]) -> Array:
        p = path(table.vehicle, x, z)
        turn = int(np.argmax(p.eta)) + 1
        return np.interp(eta, p.eta[:turn], p.D[:turn])

    return _share(table, eta.size, D)


def own_share_of_tyre(table: Table, slip: Array) -> Array:
    """The same of the tyre curve g at ``slip`` (n,)."""
    force = np.linspace(0.0, 1.3 * float(table.tyre.force[-1]), 2 * SETTINGS.rows)
    one = np.ones(())

    def g(x: RampParameters[float]) -> Array:
        return np.interp(slip, tyres_of(x).tyre.slip(force, one), force)

    return _share(table, slip.size, g)


def _share(table: Table, rows: int, curve: Callable[[RampParameters[float]], Array]) -> Array:
    known, own = table.posterior, own_covariance(table)
    if known.names != RampParameters._fields or np.any(np.diag(own) <= 0.0):
        return np.zeros(rows)
    covariance = tuple(tuple(row) for row in own.tolist())
    part = delta_sigma(curve, replace(known, covariance=covariance))
    whole = delta_sigma(curve, known)
    # at eta = 1 both are zero
    share = np.divide(part, whole, out=np.zeros(rows), where=whole > 0.0)
    return np.asarray(np.minimum(share, 1.0) ** 2)
