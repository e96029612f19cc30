"""The answer of the split filter: the pads' ratio, weighed against that of the table."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from calib.base.mixtures import mixture_posterior
from calib.estimation.priors import Priors
from calib.estimation.states import AT

Array = NDArray[np.float64]


class RatioStep(NamedTuple):
    """What one block did to the filter's covariance P, so that it can be taken apart afterwards.

    ``rows`` gradients of eta and slip, (2, COUNT); ``whitening`` of their innovations, (2, 2), its
    second row zero without slip; ``white`` = whitening rows P, (2, COUNT), with the P of before;
    ``opened`` whether the surface was opened in front of it.
    """

    rows: Array
    whitening: Array
    white: Array
    opened: bool = False


@dataclass(frozen=True)
class PadRatio:
    """The filter's answer per block, shapes (k,), [1].

    ``log_pad_ratio`` with ``sigma``; its ``change`` since the ramp with ``change_sigma``, in which
    what is common to both days falls out; ``nominal_weight`` that the pads have the table's ratio;
    ``log_stiffness`` of the surface with its sigma; ``load_shift``, ``elastic_share`` of the load
    transfer; ``innovation_eta``, ``innovation_slip`` over their sigma (NaN where not measured);
    ``log_density`` logarithm of the probability density of what each block measured, less a
    constant; ``changes`` times of surface changes [s];
    ``bumps`` begin and end [s] of blocks in a row that were not taken in, as over a bump.
    """

    log_pad_ratio: Array
    sigma: Array
    change: Array
    change_sigma: Array
    nominal_weight: Array
    log_stiffness: Array
    log_stiffness_sigma: Array
    load_shift: Array
    elastic_share: Array
    innovation_eta: Array
    innovation_slip: Array
    log_density: Array
    changes: tuple[float, ...]
    bumps: tuple[tuple[float, float], ...]

    @property
    def evidence(self) -> Array:
        """Logarithm of the density of all that was measured until each block, less a constant.

        The filter runs with pads that are free; pads that are the ramp's are one half of what is
        thought possible, and count by their weight (`calib.base.mixtures`).
        """
        return np.asarray(np.cumsum(self.log_density) - np.log1p(-self.nominal_weight))


KEPT = (
    (AT.log_pad_ratio, AT.log_pad_ratio),
    (AT.table_log_pad_ratio, AT.table_log_pad_ratio),
    (AT.log_pad_ratio, AT.table_log_pad_ratio),
    (AT.log_stiffness, AT.log_stiffness),
)
"""The entries of the covariance that the answer needs."""


def weigh(
    x: Array,
    kept: Array,
    innovation: Array,
    log_density: Array,
    changes: tuple[float, ...],
    bumps: tuple[tuple[float, float], ...],
    odds_by_level: Array,
    priors: Priors,
) -> PadRatio:
    """Weigh the ratio against the table's and add what a strange surface leaves open.

    ``x`` states (k, COUNT); ``kept`` the entries `KEPT` of their covariance (k, 4); ``innovation``
    (k, 2) of eta and slip; ``log_density`` (k,), ``changes`` and ``bumps`` are handed on;
    ``odds_by_level`` (k,) factor on the odds that the ratio is the table's [1]. A ratio that cannot
    be told from the table's is given back as the table's (`calib.base.mixtures`).
    """
    today, then, between, stiffness = kept.T
    log_ratio, log_stiffness = x[:, AT.log_pad_ratio], x[:, AT.log_stiffness]
    foreign = (priors.foreign * log_stiffness) ** 2
    deviation = log_ratio - x[:, AT.table_log_pad_ratio]
    variance = np.maximum(today + then - 2.0 * between, 1e-12) + foreign
    odds = priors.ratio_odds * odds_by_level
    posterior = mixture_posterior(
        deviation, np.sqrt(variance), priors.ratio, odds, priors.ratio_alike
    )
    # the ratio given the deviation: the rest moves along its correlation with the deviation
    along = (today - between + foreign) / variance
    rest = np.maximum(today + foreign - along**2 * variance, 0.0)
    return PadRatio(
        log_pad_ratio=log_ratio + along * (posterior.mean - deviation),
        sigma=np.sqrt(rest + along**2 * posterior.sigma**2),
        change=posterior.mean,
        change_sigma=posterior.sigma,
        nominal_weight=posterior.nominal_weight,
        log_stiffness=log_stiffness,
        log_stiffness_sigma=np.sqrt(np.maximum(stiffness, 0.0)),
        load_shift=x[:, AT.load_shift],
        elastic_share=x[:, AT.elastic_share],
        innovation_eta=innovation[:, 0],
        innovation_slip=innovation[:, 1],
        log_density=log_density,
        changes=changes,
        bumps=bumps,
    )
