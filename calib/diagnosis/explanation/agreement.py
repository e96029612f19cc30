"""How far the runs disagree on the parameters: the width of the intervals.

    innovations of a run --> the part that its own parameters could take out --> chi-square, k each

Where the model is right, all runs ask for the same parameters but for their noise: the parts add
up to about k (G - 1) for k parameters and G runs. Where a form differs from the car's, or noise is
more correlated than its model, each run asks for something else. The root of what comes over what
is expected is Birge's ratio; sigma is multiplied by it where it exceeds 1. Source: Birge 1932, "The
calculation of errors by the method of least squares".

It sees only what differs between the runs. What is wrong in all of them alike, such as a drag that
grows with speed where a constant one is assumed, moves a parameter without a sign of it.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calib.base.random_effects import quantile95
from calib.diagnosis.explanation.candidate import Candidate
from calib.diagnosis.explanation.problem import joined

Array = NDArray[np.float64]


def half_widths(candidate: Candidate) -> Array:
    """Half width (k,) of the 95 % interval of each entry of a candidate's vector.

    By Student's t with one degree of freedom less than there are runs, as each parameter can
    scatter between them in its own way. One run alone is taken as two halves.
    """
    J, innovations = candidate.jacobian, joined(candidate.whitened)
    channels = [[channel.size for channel in run] for run in candidate.whitened]
    sizes = [sum(run) for run in channels]
    if len(sizes) == 1:
        J, innovations, sizes = _halved(J, innovations, channels[0])
    ratio = birge_ratio(J, innovations, sizes)
    formal = np.sqrt(np.maximum(np.diag(candidate.covariance), 0.0))
    return np.asarray(quantile95(len(sizes) - 1) * max(ratio, 1.0) * formal)


def birge_ratio(J: Array, innovations: Array, sizes: Sequence[int]) -> float:
    """Root of the chi-square between groups of rows over its expectation [1].

    ``J`` (n, k) derivatives, ``innovations`` (n,) at the optimum, ``sizes`` of the groups, which
    follow each other and add up to n. 1 but for chance where the innovations are white with
    variance 1 and all groups have the same parameters.
    """
    ends = np.cumsum(sizes)[:-1]
    parts = zip(np.split(J, ends), np.split(innovations, ends), strict=True)
    # a group that does not feel a parameter has no part for it
    own = [(np.linalg.svd(j, full_matrices=False), r) for j, r in parts]
    felt = [(u[:, s > 1e-9 * s[0]], r) for (u, s, _), r in own if s[0] > 0.0]
    k = np.linalg.matrix_rank(J)
    freedom = sum(u.shape[1] for u, _ in felt) - int(k)
    chi2 = sum(float(np.sum((u.T @ r) ** 2)) for u, r in felt)
    return float(np.sqrt(chi2 / freedom)) if freedom > 0 else 1.0


def _halved(J: Array, innovations: Array, channels: list[int]) -> tuple[Array, Array, list[int]]:
    """The rows of one run, channel after channel, sorted into its first and its second half."""
    late = np.concatenate([np.arange(n) >= n // 2 for n in channels])
    order = np.argsort(late, kind="stable")
    return J[order], innovations[order], [int(np.sum(~late)), int(np.sum(late))]
