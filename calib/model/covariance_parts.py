"""What the covariance of a fit comes from: priors, lead-in, noise, and cases that are weighed.

A least-squares fit with Jacobian J has the covariance C = (J'J)^-1. Each row j of J, a prior or a
block of data, brings an error of its own, and

    C = C (J'J) C = sum over rows of (C j')(j C)

so each group of rows has its share of C. It is positive semidefinite, and the shares add up.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from calib.base.mixtures import Mixture
from calib.model.parameters import AT, RampParameters
from calib.model.ramp import OfRun, RampRun

Array = NDArray[np.float64]
Parts = Mapping[str, Array]
"""Information or covariance, (k, k), by part (`calib.table.budget`)."""

PART = RampParameters[str](
    log_compliance="tyres",
    curvature_2="tyres",
    curvature_3="tyres",
    load_exponent="tyres",
    clock_offset="zeros",
    log_pad_ratio="unlike_pads",
    log_tyre_ratio="tyres",
    radius_load="load_geometry",
)
"""The part of an uncertainty that the prior of each parameter belongs to."""

_PART_OF_RUN = OfRun("zeros", "zeros", "tyres", "unlike_pads", "unlike_pads")
"""The same of what differs from run to run."""


def information_parts(runs: list[RampRun], jacobian: Array) -> Parts:
    """Information J'J (k, k) by part; rows of ``jacobian`` as `identify` has them.

    The lead-in says where eta and slip are zero: its noise is that of the zeros. Rows after the
    data say that the pads are the same on all runs: what they miss belongs to unlike pads.
    """
    owners = [*PART, *_PART_OF_RUN * len(runs)]
    for run in runs:
        data = np.where(run.blocks.lead_in[run.use], "zeros", "noise").tolist()
        owners += data if run.slip is None else 2 * data
    owners += ["unlike_pads"] * (len(jacobian) - len(owners))
    of = np.array(owners)
    return {part: jacobian[of == part].T @ jacobian[of == part] for part in dict.fromkeys(owners)}


def posterior_parts(
    information: Parts,
    weighed: Mixture,
    along: Array,
    at: list[int],
    inside: Array,
    sigma: Array,
    free: Array,
) -> Parts:
    """Covariance (k, k) of a weighed fit by part.

    The parameters ``at`` depart from what is declared or do not: ``free`` (cases, m), with a prior
    of ``sigma`` (cases, m) in place of the one in ``information``, of ``inside`` (m,). ``along``
    (k, m) is how the others follow them, ``weighed`` the cases. The covariance is the mean of those
    of the cases, and the spread between the cases

        sum_i w_i (x_i - x)(x_i - x)' = sum over pairs of w_i w_j (x_i - x_j)(x_i - x_j)'

    of which each pair goes in equal shares to the parameters that depart in one case only.
    """
    size = len(along)
    out = {part: np.zeros((size, size)) for part in information}
    for case, weight in enumerate(weighed.weights):
        now = _with_priors(information, at, inside, sigma[case])
        covariance = _covariance(now)
        for part, own in now.items():
            out[part] += weight * covariance @ own @ covariance
    for one in range(len(free)):
        for other in range(one):
            apart = along @ (weighed.means[one] - weighed.means[other])
            differ = [i for i, a, b in zip(at, free[one], free[other], strict=True) if a != b]
            spread = weighed.weights[one] * weighed.weights[other] * np.outer(apart, apart)
            for i in differ:
                out[PART[i]] += spread / len(differ)
    return out


def scatter_parts(
    information: Parts, weights: Array, at: list[int], inside: Array, taken: Array, real: Array
) -> Parts:
    """Covariance (k, k), by part, that is added where the parameters ``at`` really scatter more.

    ``taken`` (cases, m) the sigma that the estimate took for them in each case, ``real`` theirs,
    ``inside`` (m,) that of their priors in ``information``, ``weights`` (cases,) of the cases.
    Within a case the parameters share what is added by how much less it would be of the pads' ratio
    if each was as close as it was taken.
    """
    ratio = AT.log_pad_ratio
    out = {PART[i]: np.zeros_like(next(iter(information.values()))) for i in at}
    for weight, narrow, wide in zip(weights, taken, real, strict=True):
        added = _covariance(_with_priors(information, at, inside, wide))
        spared = []
        for place in range(len(at)):
            known = np.where(np.arange(len(at)) == place, narrow, wide)
            less = _covariance(_with_priors(information, at, inside, known))
            spared.append(max(float(added[ratio, ratio] - less[ratio, ratio]), 0.0))
        added = added - _covariance(_with_priors(information, at, inside, narrow))
        if (total := sum(spared)) > 0.0:
            for i, share in zip(at, spared, strict=True):
                out[PART[i]] += weight * share / total * added
    return out


def _with_priors(
    information: Parts, at: list[int], inside: Array, sigma: Array
) -> dict[str, Array]:
    """The information with priors of ``sigma`` (m,) of the parameters ``at`` for those inside."""
    out = {part: own.copy() for part, own in information.items()}
    for i, spread, own in zip(at, sigma, inside, strict=True):
        out[PART[i]][i, i] += spread**-2.0 - own**-2.0
    return out


def _covariance(information: Parts) -> Array:
    """Inverse of all information (k, k)."""
    total = np.sum(list(information.values()), axis=0)
    return np.asarray(np.linalg.inv(total))
