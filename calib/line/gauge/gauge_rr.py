"""Gauge R&R metrics from an analysis of variance, with 95 % intervals.

    GRR^2 = EV^2 + AV^2          scatter of the measurement: repeatability and reproducibility
    TV^2 = GRR^2 + PV^2          PV: the cars themselves
    %GRR = GRR/TV                ndc = 1.41 PV/GRR, rounded down (AIAG MSA, 4th ed.)
    %GRR of the tolerance = 6 GRR/(USL - LSL)                    (the same, ch. III, section B)

%GRR and ndc compare the gauge with the cars of the study. Where the cars do not differ, %GRR is
near 100 % for any gauge and has no meaning; that of the tolerance still has.

AV is station and car-by-station together. Intervals are generalised confidence intervals (Burdick,
Borror, Montgomery: Design and Analysis of Gauge R&R Studies, SIAM 2005): draws of
nu MS/chi2(nu) replace each expected mean square, and the 2.5 and 97.5 % points of the results are
the ends. `tests/studies/results/repeatability_coverage.md` says how often they contain the truth.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from calib.line.gauge.anova import CAR, INTERACTION, REPEATABILITY, STATION, Anova

Array = NDArray[np.float64]

REPRODUCIBILITY, GAUGE, TOTAL = "reproducibility", "gauge", "total"
SIGMAS = 6.0
"""Standard deviations across a process, which AIAG compares with the tolerance."""
NDC = 1.41
"""Factor of ndc: the square root of 2 as rounded by AIAG."""

DRAWS = 20_000
"""Number of draws for an interval: the error of its ends is a few percent of its width."""


@dataclass(frozen=True)
class VarianceComponent:
    """A variance in the metric's unit squared.

    ``raw`` estimate; ``variance`` the same, or zero if it is negative; ``low``, ``high`` 95 %
    interval.
    """

    variance: float
    raw: float
    low: float
    high: float

    @property
    def sd(self) -> float:
        """Standard deviation, in the metric's unit."""
        return float(np.sqrt(self.variance))

    @property
    def sd95(self) -> tuple[float, float]:
        """95 % interval of the standard deviation."""
        return float(np.sqrt(self.low)), float(np.sqrt(self.high))


@dataclass(frozen=True)
class GaugeRR:
    """Components of a metric's scatter.

    ``components`` by name: those of the analysis, ``reproducibility`` if there are stations, then
    ``gauge`` and ``total``. ``grr`` share of the gauge in the total standard deviation [1];
    ``ndc`` number of distinct categories, not rounded [1]; each with its 95 % interval.
    ``tolerance`` six standard deviations of the gauge over the tolerance's width [1], and
    its interval; None without a tolerance.
    """

    components: dict[str, VarianceComponent]
    grr: float
    grr95: tuple[float, float]
    ndc: float
    ndc95: tuple[float, float]
    tolerance: float | None = None
    tolerance95: tuple[float, float] | None = None

    @property
    def cars_differ(self) -> bool:
        """Whether the 95 % interval of the cars' standard deviation is above zero."""
        return self.components[CAR].low > 0.0

    @property
    def categories(self) -> int:
        """Number of distinct categories, rounded down."""
        return int(min(self.ndc, 1e9))

    @property
    def negative(self) -> tuple[str, ...]:
        """Causes with a negative estimated variance, which counts as zero."""
        sums = (REPRODUCIBILITY, GAUGE, TOTAL)
        return tuple(n for n, c in self.components.items() if c.raw < 0.0 and n not in sums)


def gauge_rr(found: Anova, tolerance: float | None = None) -> GaugeRR:
    """Components, %GRR and ndc of an analysis, and %GRR of a ``tolerance``.

    ``tolerance`` is the width USL - LSL in the metric's unit. Raises ValueError if repeats do not
    scatter.
    """
    if sum(source.ss for source in found.sources) <= 0.0 or found.variances[REPEATABILITY] <= 0.0:
        raise ValueError("nothing scatters between repeats")
    variances = {name: np.asarray(value) for name, value in found.variances.items()}
    raw, point = _derived(variances, clip=False), _derived(variances)
    spread = _derived(_drawn(found))
    components = {
        name: VarianceComponent(float(point[name]), float(raw[name]), *_ends(spread[name]))
        for name in point
    }
    gauge = components[GAUGE]
    per = None if tolerance is None else SIGMAS / tolerance
    return GaugeRR(
        components,
        float(_grr(point)),
        _ends(_grr(spread)),
        float(_ndc(point)),
        _ends(_ndc(spread)),
        None if per is None else per * gauge.sd,
        None if per is None else (per * gauge.sd95[0], per * gauge.sd95[1]),
    )


def _drawn(found: Anova) -> dict[str, Array]:
    """Draws of every variance, each (DRAWS,): C^-1 applied to nu MS/chi2(nu)."""
    ms = [
        source.ms * source.effective_df / _chi2(source.effective_df, i)
        for i, source in enumerate(found.sources)
    ]
    solved = np.linalg.solve(found.expected_mean_squares, np.array(ms))
    return dict(zip(found.variances, solved, strict=True))


@lru_cache(maxsize=16)  # 160 kB each; unbalanced designs seldom repeat their degrees of freedom
def _chi2(nu: float, stream: int) -> Array:
    """Chi-square numbers (DRAWS,), always the same, so that a report is reproducible."""
    return np.random.default_rng([20, stream]).chisquare(nu, DRAWS)


def _derived(variances: dict[str, Array], clip: bool = True) -> dict[str, Array]:
    """Variances and their sums; with ``clip`` a negative one counts as zero in all of them."""
    v = {n: np.maximum(x, 0.0) if clip else x for n, x in variances.items()}
    stations = [v[n] for n in (STATION, INTERACTION) if n in v]
    out = {REPEATABILITY: v[REPEATABILITY]} | {n: v[n] for n in (STATION, INTERACTION) if n in v}
    if stations:
        out[REPRODUCIBILITY] = np.sum(stations, axis=0)
    out[GAUGE] = np.sum([v[REPEATABILITY], *stations], axis=0)
    out[CAR] = v[CAR]
    out[TOTAL] = out[GAUGE] + v[CAR]
    return out


def _grr(v: dict[str, Array]) -> Array:
    return np.asarray(np.sqrt(v[GAUGE] / v[TOTAL]))


def _ndc(v: dict[str, Array]) -> Array:
    return np.asarray(NDC * np.sqrt(v[CAR] / v[GAUGE]))


def _ends(draws: Array) -> tuple[float, float]:
    low, high = np.quantile(draws, [0.025, 0.975])
    return float(low), float(high)
