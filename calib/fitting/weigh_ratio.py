"""Pads, tyres and radii of the axles: as declared, or not."""

from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from calib.base.mixtures import weigh_hypotheses
from calib.model.covariance_parts import Parts, posterior_parts, scatter_parts
from calib.model.parameters import AT, priors_with
from calib.model.settings import SETTINGS
from calib.table.table import Value

Array = NDArray[np.float64]


class _WeighedRatio(NamedTuple):
    """What comes of weighing: all parameters and zeros of a fit, (k,).

    ``mean``; ``parts`` of the covariance (k, k), and ``scatter`` (k, k) which is in them, see
    `calib.table.table.TyrePosterior`; ``declared_weight`` that the pads are as declared.
    """

    mean: Array
    parts: Parts
    scatter: Array
    declared_weight: float


def weigh_ratio(x: Array, information: Parts, stated: Value | None = None) -> _WeighedRatio:
    """Weigh pads, tyres and radii that are as declared against such that are not.

    The fit sees the force share of each axle over its tyres' stiffness only: pads 10 % apart,
    tyres 10 % apart and radii that fall under load leave much the same traces. The eight cases in
    which each of the three departs or does not are weighed; the other parameters follow along their
    correlation with the three.

    What cannot be told from the declared is taken as declared: weights and mean are those of a
    narrow tolerance. Real pads and tyres scatter more, and such that differ against each other look
    like a car as declared: within each case the covariance is that of the scatter.

    ``stated`` what the user says of the pads' ratio, of which ``x`` and ``information`` know: there
    is then nothing to weigh of it.
    """
    covariance = np.linalg.inv(sum(information.values(), np.zeros((x.size, x.size))))
    at = [AT.log_pad_ratio, AT.log_tyre_ratio, AT.radius_load]
    priors = priors_with(stated)
    wide, centre = (np.array([getattr(priors[i], of) for i in at]) for of in ("sigma", "mean"))
    s = SETTINGS
    narrow = np.array([s.pad_tolerance, s.tyre_tolerance, s.radius_tolerance])
    scatter = np.array([s.pad_scatter, s.tyre_scatter, s.radius_scatter])
    if stated is not None:
        narrow[0] = scatter[0] = stated.sigma
    free = np.array(list(product((False, True), repeat=3)))
    chance = np.array([s.pads_differ, s.tyres_differ, s.radii_fall])
    taken, real = (np.where(free, wide, declared) for declared in (narrow, scatter))
    precision = np.asarray(np.linalg.inv(covariance[np.ix_(at, at)]))
    weighed = weigh_hypotheses(
        (precision - np.diag(wide**-2.0))[None],
        (precision @ (x[at] - centre))[None],
        taken,
        np.where(free, chance, 1.0 - chance).prod(axis=1),
    )
    along = covariance[:, at] @ precision
    parts = dict(posterior_parts(information, weighed, along, at, wide, taken, free))
    more = scatter_parts(information, weighed.weights, at, wide, taken, real)
    for part, share in more.items():
        parts[part] = parts[part] + share
    return _WeighedRatio(
        mean=x + along @ (centre + weighed.mean - x[at]),
        parts=parts,
        scatter=sum(more.values(), np.zeros_like(covariance)),
        declared_weight=float(weighed.weights[~free[:, 0]].sum()),
    )
