r"""Gauge repeatability and reproducibility of a metric: variance components, %GRR and ndc.

    y = mean + car_i + station_j + (car x station)_ij + repeat      all random but the mean

The random terms are the causes of scatter. The design says which cars were on which stations how
often. `anova` splits the sum of squares by cause, in this order; each cause is adjusted for the
causes before it (type I, Henderson's third method). The mean square MS of a cause is its sum of
squares over its degrees of freedom. Expected mean squares are linear in the variances sigma^2 of
the causes, with a matrix C that depends on the design only:

    E[MS] = C sigma^2,      so the estimate is  sigma^2 = C^-1 MS

In a full design this is the textbook table (AIAG, Measurement Systems Analysis, 4th ed., app. A;
Montgomery, Design and Analysis of Experiments, ch. 13). With missing cells the estimates stay
unbiased; the intervals are approximate, with the degrees of freedom of Satterthwaite (1946).

`gauge_rr` combines the standard deviations EV of the repeats, AV of station and car x station
together, and PV of the cars. A negative variance counts as zero.

    GRR^2 = EV^2 + AV^2          the gauge: repeatability and reproducibility
    TV^2 = GRR^2 + PV^2          total
    %GRR = GRR/TV                ndc, number of distinct categories = 1.41 PV/GRR, rounded down
    %GRR of the tolerance = 6 GRR/(USL - LSL), upper less lower limit  (AIAG, ch. III, section B)

If the cars do not differ, %GRR is near 100 % for any gauge, and only %GRR of the tolerance helps.
Intervals are generalised confidence intervals (Burdick, Borror, Montgomery: Design and Analysis of
Gauge R&R Studies, SIAM 2005): the 2.5 and 97.5 % points over draws, in which nu MS/chi2(nu) stands
for each expected mean square; nu are its degrees of freedom. How often intervals contain the truth
is in `tests/studies/results/repeatability_coverage.md`.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array

Codes = NDArray[np.int64]  # number of the car, or of the station, of each of n readings (n,)

CAR, STATION, INTERACTION, REPEATABILITY = "car", "station", "car_by_station", "repeatability"
REPRODUCIBILITY, GAUGE, TOTAL = "reproducibility", "gauge", "total"

_RANK = 1e-9  # singular value below which a direction counts as zero, over the norm of the columns
_SIGMAS = 6.0  # number of standard deviations of the gauge that AIAG compares with the tolerance
_NDC = 1.41  # factor of ndc: the square root of 2 as rounded by AIAG
_DRAWS = 20_000  # for an interval: the error of its ends is a few percent of its width


@dataclass(frozen=True)
class _VarianceSource:
    """A row of the analysis of variance."""

    source: str  # the cause
    df: int  # degrees of freedom
    ss: float  # sum of squares [unit of the metric squared]
    ms: float  # mean square [unit of the metric squared]
    effective_df: float  # of the chi-square distribution of the mean square


@dataclass(frozen=True)
class Anova:
    """An analysis of variance with k causes."""

    sources: tuple[_VarianceSource, ...]
    variances: dict[str, float]  # estimates by cause, which may be negative
    expected_mean_squares: Array  # C, (k, k): a row for each mean square


def causes_of(car: Codes, station: Codes) -> tuple[str, ...]:
    """Return the causes that the design of n readings can separate, in order.

    A cause is separated if it adds something to the causes before it, as stations do if a car was
    on two of them. The interaction must also leave something to the repeats.
    """
    causes, columns = [CAR], _columns(car)
    for cause, codes in ((STATION, station), (INTERACTION, _cell(car, station))):
        extended = np.hstack([columns, _columns(codes)])
        rank = np.linalg.matrix_rank(extended)
        adds_nothing = rank == np.linalg.matrix_rank(columns)
        leaves_no_repeats = cause == INTERACTION and rank == car.size
        if adds_nothing or leaves_no_repeats:
            break
        causes.append(cause)
        columns = extended
    return (*causes, REPEATABILITY)


def anova(y: Array, car: Codes, station: Codes, causes: tuple[str, ...] = ()) -> Anova:
    """Return the analysis of variance of ``y`` (n,) by ``causes``, by default those of `causes_of`.

    Raises ValueError if a cause has no degree of freedom.
    """
    causes = causes or causes_of(car, station)
    codes = {CAR: car, STATION: station, INTERACTION: _cell(car, station)}
    # y = mean + sum of Z u over the causes, with Z (n, levels) and u the effect of each level
    Z = {cause: _columns(codes[cause]) if cause in codes else np.eye(y.size) for cause in causes}
    directions = _directions(Z)
    df = {cause: U.shape[1] for cause, U in directions.items()}
    centred = y - np.mean(y)
    ss = {cause: float(np.sum((U.T @ centred) ** 2)) for cause, U in directions.items()}
    ms = {cause: ss[cause] / df[cause] for cause in causes}
    C = np.empty((len(causes), len(causes)))
    for i, (cause, U) in enumerate(directions.items()):
        # the mean square is |U' y|^2/df: in its expectation a variance has the factor |U' Z|^2/df
        C[i] = [float(np.sum((U.T @ z) ** 2)) / df[cause] for z in Z.values()]
    variances = dict(zip(causes, np.linalg.solve(C, [*ms.values()]).tolist(), strict=True))
    sources = (
        _VarianceSource(cause, df[cause], ss[cause], ms[cause], _effective_df(U, Z, variances))
        for cause, U in directions.items()
    )
    return Anova(tuple(sources), variances, C)


def _directions(Z: dict[str, Array]) -> dict[str, Array]:
    """Return orthonormal directions U (n, df) of each cause from its columns ``Z`` (n, levels).

    All directions are orthogonal to the mean. Raises ValueError if a cause has none.
    """
    n = len(next(iter(Z.values())))
    basis = np.ones((n, 1)) / np.sqrt(n)
    directions: dict[str, Array] = {}
    for cause, columns in Z.items():
        U, size, _ = np.linalg.svd(columns - basis @ (basis.T @ columns), full_matrices=False)
        least = _RANK * max(1.0, float(np.max(np.abs(columns).sum(axis=0))))
        directions[cause] = U[:, size > least]
        if directions[cause].shape[1] == 0:
            raise ValueError(f"no degree of freedom left for {cause}")
        basis = np.hstack([basis, directions[cause]])
    return directions


def _cell(car: Codes, station: Codes) -> Codes:
    """Number the pairs of car and station."""
    return np.asarray(car * (int(np.max(station)) + 1) + station)


def _columns(codes: Codes) -> Array:
    """Return for each level a column that is 1 in its readings and else 0, (n, levels)."""
    return np.asarray(codes[:, None] == np.unique(codes)[None, :], dtype=np.float64)


def _effective_df(U: Array, Z: dict[str, Array], variances: dict[str, float]) -> float:
    """Return Satterthwaite's degrees of freedom of the mean square with the directions ``U``.

    These are tr(M)^2/tr(M^2), where M (df, df) is the covariance of U' y. A negative variance
    counts as zero.
    """
    projections = {cause: U.T @ columns for cause, columns in Z.items()}  # (df, levels)
    M = np.sum([max(variances[c], 0.0) * P @ P.T for c, P in projections.items()], axis=0)
    trace_of_square = float(np.sum(M * M))
    return float(np.trace(M) ** 2 / trace_of_square) if trace_of_square > 0.0 else float(U.shape[1])


@dataclass(frozen=True)
class _Component:
    """A standard deviation in the metric's unit, with its 95 % interval."""

    sd: float
    ci95: tuple[float, float]


@dataclass(frozen=True)
class _Ratio:
    """A ratio [1] with its 95 % interval."""

    value: float
    ci95: tuple[float, float]


@dataclass(frozen=True)
class GaugeRR:
    """The scatter of a metric, as the JSON document of a study has it."""

    anova: tuple[_VarianceSource, ...]
    components: dict[str, _Component]  # by cause; also `REPRODUCIBILITY`, `GAUGE` and `TOTAL`
    grr: _Ratio  # %GRR
    ndc: _Ratio
    grr_of_tolerance: _Ratio | None  # None without a tolerance
    cars_differ: bool  # whether the interval of the standard deviation of the cars is above zero


def gauge_rr(analysis: Anova, tolerance: float | None = None) -> GaugeRR:
    """Return the scatter by an analysis; ``tolerance`` is USL - LSL in the metric's unit.

    Raises ValueError if repeats do not scatter.
    """
    if analysis.variances[REPEATABILITY] <= 0.0:
        raise ValueError("nothing scatters between repeats")
    # draws of the expected mean squares, nu MS/chi2(nu), and of the variances, (k, _DRAWS)
    ms = [x.ms * x.effective_df / _chi2(x.effective_df, i) for i, x in enumerate(analysis.sources)]
    variances = np.linalg.solve(analysis.expected_mean_squares, np.array(ms))
    estimates = _component_variances(analysis.variances)
    draws = _component_variances(dict(zip(analysis.variances, variances, strict=True)))
    components = {}
    for name, variance in estimates.items():
        low, high = _interval(draws[name])
        components[name] = _Component(math.sqrt(variance), (math.sqrt(low), math.sqrt(high)))
    grr, ndc = _ratios(estimates)
    grr_draws, ndc_draws = _ratios(draws)
    grr_of_tolerance = None
    if tolerance:
        gauge, factor = components[GAUGE], _SIGMAS / tolerance
        low, high = gauge.ci95
        grr_of_tolerance = _Ratio(factor * gauge.sd, (factor * low, factor * high))
    return GaugeRR(
        anova=analysis.sources,
        components=components,
        grr=_Ratio(float(grr), _interval(grr_draws)),
        ndc=_Ratio(int(min(float(ndc), 1e9)), _interval(ndc_draws)),  # a whole number, never inf
        grr_of_tolerance=grr_of_tolerance,
        cars_differ=components[CAR].ci95[0] > 0.0,
    )


@lru_cache(maxsize=16)
def _chi2(nu: float, stream: int) -> Array:
    """Return chi-square draws (_DRAWS,), the same in every run for each ``stream``."""
    return np.random.default_rng([20, stream]).chisquare(nu, _DRAWS)


def _component_variances(variances: Mapping[str, Array | float]) -> dict[str, Array]:
    """Return the variance of each component in `GaugeRR`; a negative variance counts as zero."""
    v = {cause: np.maximum(x, 0.0) for cause, x in variances.items()}
    by_station = {cause: v[cause] for cause in (STATION, INTERACTION) if cause in v}
    components = {REPEATABILITY: v[REPEATABILITY], **by_station}
    if by_station:
        components[REPRODUCIBILITY] = np.sum([*by_station.values()], axis=0)
    components[GAUGE] = np.sum([v[REPEATABILITY], *by_station.values()], axis=0)
    return components | {CAR: v[CAR], TOTAL: components[GAUGE] + v[CAR]}


def _ratios(v: dict[str, Array]) -> tuple[Array, Array]:
    """Return %GRR and ndc, not rounded, from the variances of the components."""
    return np.sqrt(v[GAUGE] / v[TOTAL]), _NDC * np.sqrt(v[CAR] / v[GAUGE])


def _interval(draws: Array) -> tuple[float, float]:
    low, high = np.quantile(draws, [0.025, 0.975])
    return float(low), float(high)
