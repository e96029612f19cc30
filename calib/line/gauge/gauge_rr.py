r"""Gauge repeatability and reproducibility of a metric: variance components, %GRR and ndc.

    y = mean + car_i + station_j + (car x station)_ij + repeat      all but the mean random

The sum of squares is split by cause, in this order, each adjusted for the ones before it (type I,
Henderson's third method). The expected mean squares are linear in the variances:

    E[MS] = C sigma^2      C from the design only, so  sigma^2 = C^-1 MS

In a full design this is the textbook table (AIAG, Measurement Systems Analysis, 4th ed., app. A;
Montgomery, Design and Analysis of Experiments, ch. 13). With missing cells the estimates stay
unbiased; the intervals are approximate, with the degrees of freedom of Satterthwaite (1946).

    GRR^2 = EV^2 + AV^2          scatter of the measurement: repeatability and reproducibility
    TV^2 = GRR^2 + PV^2          PV: the cars themselves
    %GRR = GRR/TV                ndc = 1.41 PV/GRR, rounded down (AIAG)
    %GRR of the tolerance = 6 GRR/(USL - LSL)                    (the same, ch. III, section B)

Where the cars do not differ, %GRR is near 100 % for any gauge; only that of the tolerance helps.
AV is station and car-by-station together; a negative variance counts as zero. Intervals are
generalised confidence intervals (Burdick, Borror, Montgomery: Design and Analysis of Gauge R&R
Studies, SIAM 2005): the 2.5 and 97.5 % points of draws of nu MS/chi2(nu) for each expected mean
square. How often they contain the truth:
`tests/studies/results/repeatability_coverage.md`.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array

Codes = NDArray[np.int64]

CAR, STATION, INTERACTION, REPEATABILITY = "car", "station", "car_by_station", "repeatability"
REPRODUCIBILITY, GAUGE, TOTAL = "reproducibility", "gauge", "total"

_RANK = 1e-9
"""Singular value over the largest one below which a direction is ignored."""

_SIGMAS = 6.0
"""Standard deviations across a process, which AIAG compares with the tolerance."""
_NDC = 1.41
"""Factor of ndc: the square root of 2 as rounded by AIAG."""

_DRAWS = 20_000
"""Number of draws for an interval: the error of its ends is a few percent of its width."""


@dataclass(frozen=True)
class _VarianceSource:
    """One row of the table: ``ss``, ``ms`` in the metric's unit squared, ``df`` degrees of freedom.

    ``effective_df``: of the chi-square distribution of the mean square, possibly approximate.
    """

    source: str
    df: int
    ss: float
    ms: float
    effective_df: float


@dataclass(frozen=True)
class Anova:
    """The table, and the estimated variances; a negative estimate stays negative.

    ``expected_mean_squares`` C: coefficient of each variance in each mean square, (k, k).
    """

    sources: tuple[_VarianceSource, ...]
    variances: dict[str, float]
    expected_mean_squares: Array


def terms_of(car: Codes, station: Codes) -> tuple[str, ...]:
    """Causes that the design can separate, in order; ``car``, ``station`` codes (n,).

    The interaction needs a repeat in a cell, the station a car that was on two of them.
    """
    names, columns = [CAR], _columns(car)
    for name, codes in ((STATION, station), (INTERACTION, _cell(car, station))):
        extended = np.hstack([columns, _columns(codes)])
        rank = np.linalg.matrix_rank(extended)
        if rank == np.linalg.matrix_rank(columns) or (name == INTERACTION and rank == car.size):
            break
        names.append(name)
        columns = extended
    return (*names, REPEATABILITY)


def anova(y: Array, car: Codes, station: Codes, terms: tuple[str, ...] | None = None) -> Anova:
    """Analysis of variance of ``y`` (n,) by the causes ``terms``; those from `terms_of` if None.

    Raises ValueError if a cause has no degree of freedom left.
    """
    names = terms or terms_of(car, station)
    codes = {CAR: car, STATION: station, INTERACTION: _cell(car, station)}
    Z = {n: _columns(codes[n]) if n in codes else np.eye(y.size) for n in names}
    parts = _partition(Z)
    df = {n: U.shape[1] for n, U in parts.items()}
    centred = y - np.mean(y)
    ss = {n: float(np.sum((U.T @ centred) ** 2)) for n, U in parts.items()}
    ms = {n: ss[n] / df[n] for n in names}
    # E[MS] has tr(U U' Z Z')/df of each variance
    C = np.array(
        [[float(np.sum((U.T @ z) ** 2)) / df[n] for z in Z.values()] for n, U in parts.items()]
    )
    variances = dict(zip(names, map(float, np.linalg.solve(C, [*ms.values()])), strict=True))
    sources = (
        _VarianceSource(n, df[n], ss[n], ms[n], _effective_df(U, Z, variances))
        for n, U in parts.items()
    )
    return Anova(tuple(sources), variances, C)


def _partition(Z: dict[str, Array]) -> dict[str, Array]:
    """Orthonormal directions of each cause, orthogonal to the mean and to the causes before it."""
    n = len(next(iter(Z.values())))
    basis = np.ones((n, 1)) / np.sqrt(n)
    parts: dict[str, Array] = {}
    for name, columns in Z.items():
        U, size, _ = np.linalg.svd(columns - basis @ (basis.T @ columns), full_matrices=False)
        least = _RANK * max(1.0, float(np.max(np.abs(columns).sum(axis=0))))
        parts[name] = U[:, size > least]
        if parts[name].shape[1] == 0:
            raise ValueError(f"no degree of freedom left for {name}")
        basis = np.hstack([basis, parts[name]])
    return parts


def _cell(car: Codes, station: Codes) -> Codes:
    return np.asarray(car * (int(np.max(station)) + 1) + station)


def _columns(codes: Codes) -> Array:
    """One column of zeros and ones for each level, (n, levels)."""
    return np.asarray(codes[:, None] == np.unique(codes)[None, :], dtype=np.float64)


def _effective_df(U: Array, Z: dict[str, Array], variances: dict[str, float]) -> float:
    """Satterthwaite's degrees of freedom of y' U U' y; negative ``variances`` count as zero.

    tr(M)^2 / tr(M^2) with M = U' V U: the number of directions if M is a multiple of 1.
    """
    parts = [max(variances[n], 0.0) * (U.T @ z) @ (U.T @ z).T for n, z in Z.items()]
    M = np.sum(parts, axis=0)
    square = float(np.sum(M * M))
    return float(np.trace(M) ** 2 / square) if square > 0.0 else float(U.shape[1])


@dataclass(frozen=True)
class _Component:
    """Standard deviation in the metric's unit, with its 95 % interval."""

    sd: float
    ci95: tuple[float, float]


@dataclass(frozen=True)
class _Ratio:
    """A ratio [1] with its 95 % interval."""

    value: float
    ci95: tuple[float, float]


@dataclass(frozen=True)
class GaugeRR:
    """Components of a metric's scatter, as the document has them.

    ``components`` by name: those of the analysis, ``reproducibility`` if there are stations, then
    ``gauge`` and ``total``; ``grr`` standard deviation of the gauge over the total; ``ndc`` rounded
    down; ``grr_of_tolerance`` six standard deviations of the gauge over the tolerance, None without
    one; ``cars_differ`` whether the interval of the cars' standard deviation is above zero.
    """

    anova: tuple[_VarianceSource, ...]
    components: dict[str, _Component]
    grr: _Ratio
    ndc: _Ratio
    grr_of_tolerance: _Ratio | None
    cars_differ: bool


def gauge_rr(analysis: Anova, tolerance: float | None = None) -> GaugeRR:
    """Components, %GRR and ndc of an analysis, and %GRR of a ``tolerance``.

    ``tolerance`` is the width USL - LSL in the metric's unit. Raises ValueError if repeats do not
    scatter.
    """
    if analysis.variances[REPEATABILITY] <= 0.0:
        raise ValueError("nothing scatters between repeats")
    # generalised intervals: C^-1 applied to draws of nu MS/chi2(nu)
    ms = [x.ms * x.effective_df / _chi2(x.effective_df, i) for i, x in enumerate(analysis.sources)]
    solved = np.linalg.solve(analysis.expected_mean_squares, np.array(ms))
    point = _derived(analysis.variances)
    draws = _derived(dict(zip(analysis.variances, solved, strict=True)))
    ends = {name: np.sqrt(_ends(draws[name])).tolist() for name in point}
    components = {n: _Component(math.sqrt(x), (*ends[n],)) for n, x in point.items()}
    (grr, ndc), (grrs, ndcs) = _ratios(point), _ratios(draws)
    factor = _SIGMAS / tolerance if tolerance else math.nan
    of_tolerance = _Ratio(factor * components[GAUGE].sd, (*(factor * x for x in ends[GAUGE]),))
    return GaugeRR(
        analysis.sources,
        components,
        _Ratio(float(grr), _ends(grrs)),
        _Ratio(int(min(float(ndc), 1e9)), _ends(ndcs)),
        of_tolerance if tolerance else None,
        ends[CAR][0] > 0.0,
    )


@lru_cache(maxsize=16)  # 160 kB each; unbalanced designs seldom repeat their degrees of freedom
def _chi2(nu: float, stream: int) -> Array:
    """Chi-square numbers (_DRAWS,), always the same, so that a report is reproducible."""
    return np.random.default_rng([20, stream]).chisquare(nu, _DRAWS)


def _derived(variances: Mapping[str, Array | float]) -> dict[str, Array]:
    """All components of the scatter, a negative variance as zero."""
    v = {name: np.maximum(x, 0.0) for name, x in variances.items()}
    stations = {n: v[n] for n in (STATION, INTERACTION) if n in v}
    out = {REPEATABILITY: v[REPEATABILITY], **stations}
    if stations:
        out[REPRODUCIBILITY] = np.sum([*stations.values()], axis=0)
    out[GAUGE] = np.sum([v[REPEATABILITY], *stations.values()], axis=0)
    return out | {CAR: v[CAR], TOTAL: out[GAUGE] + v[CAR]}


def _ratios(v: dict[str, Array]) -> tuple[Array, Array]:
    return np.sqrt(v[GAUGE] / v[TOTAL]), _NDC * np.sqrt(v[CAR] / v[GAUGE])


def _ends(draws: Array) -> tuple[float, float]:
    low, high = np.quantile(draws, [0.025, 0.975])
    return float(low), float(high)
