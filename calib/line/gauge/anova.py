r"""Variance components of a metric: car, station, their interaction, and repeat.

    y = mean + car_i + station_j + (car x station)_ij + repeat      all but the mean random

The sum of squares is split into one part for each cause, in this order, each adjusted for the ones
before it (type I, Henderson's third method). The expected mean squares are linear in the variances:

    E[MS] = C sigma^2      C from the design only, so  sigma^2 = C^-1 MS

In a full design with equal repeats this is the textbook table (AIAG, Measurement Systems Analysis,
4th ed., app. A; Montgomery, Design and Analysis of Experiments, ch. 13). With unequal numbers or
missing cells the estimates are still unbiased, but the intervals become approximate: the mean
squares then follow approximately a chi-square distribution with the degrees of freedom of
Satterthwaite (1946), and are not exactly independent.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Codes = NDArray[np.int64]

CAR, STATION, INTERACTION, REPEATABILITY = "car", "station", "car_by_station", "repeatability"
RANK = 1e-9
"""Share of the largest singular value below which a direction is ignored."""


@dataclass(frozen=True)
class VarianceSource:
    """One row of the table: ``ss``, ``ms`` in the metric's unit squared, ``df`` degrees of freedom.

    ``expected`` coefficients of the variances in the expected mean square; ``effective_df`` degrees
    of freedom of the chi-square distribution of the mean square, possibly approximate.
    """

    name: str
    df: int
    ss: float
    expected: dict[str, float]
    effective_df: float

    @property
    def ms(self) -> float:
        """Mean square."""
        return self.ss / self.df


@dataclass(frozen=True)
class Anova:
    """The table, and the estimated variances; a negative estimate stays negative."""

    sources: tuple[VarianceSource, ...]
    variances: dict[str, float]

    @property
    def expected_mean_squares(self) -> Array:
        """C: coefficient of each variance in each expected mean square, shape (k, k)."""
        return np.array([list(source.expected.values()) for source in self.sources])


def terms_of(car: Codes, station: Codes) -> tuple[str, ...]:
    """Causes that the design can separate, in order; ``car``, ``station`` codes (n,).

    If no cell has a repeat, the interaction is part of the repeatability. Stations that share no
    car cannot be separated from the cars.
    """
    names = [CAR]
    if len(set(station)) > 1 and _adds([car], station):
        names.append(STATION)
        if _adds([car, station], _cell(car, station)):
            names.append(INTERACTION)
    every = np.hstack([_columns(c) for c in _codes(car, station, names)])
    if INTERACTION in names and np.linalg.matrix_rank(every) == car.size:
        names.remove(INTERACTION)
    return (*names, REPEATABILITY)


def anova(y: Array, car: Codes, station: Codes, terms: tuple[str, ...] | None = None) -> Anova:
    """Analysis of variance of ``y`` (n,) by the causes ``terms``; those from `terms_of` if None.

    Raises ValueError if a cause has no degree of freedom left.
    """
    names = terms or terms_of(car, station)
    codes = _codes(car, station, names[:-1])
    Z = dict(zip(names, [*map(_columns, codes), np.eye(y.size)], strict=True))
    parts = _partition(Z)
    about = y - np.mean(y)
    ss = {n: float(np.sum((U.T @ about) ** 2)) for n, U in parts.items()}
    expected = {n: {m: _trace(U, Z[m]) / U.shape[1] for m in Z} for n, U in parts.items()}
    C = np.array([list(row.values()) for row in expected.values()])
    solved = np.linalg.solve(C, [ss[n] / U.shape[1] for n, U in parts.items()])
    variances = dict(zip(names, map(float, solved), strict=True))
    sources = (
        VarianceSource(n, U.shape[1], ss[n], expected[n], _effective_df(U, Z, variances))
        for n, U in parts.items()
    )
    return Anova(tuple(sources), variances)


def _partition(Z: dict[str, Array]) -> dict[str, Array]:
    """Orthonormal directions of each cause, orthogonal to the mean and to the causes before it."""
    n = len(next(iter(Z.values())))
    basis = np.ones((n, 1)) / np.sqrt(n)
    parts: dict[str, Array] = {}
    for name, columns in Z.items():
        parts[name] = _new_directions(basis, columns)
        if parts[name].shape[1] == 0:
            raise ValueError(f"no degree of freedom left for {name}")
        basis = np.hstack([basis, parts[name]])
    return parts


def _codes(car: Codes, station: Codes, names: Sequence[str]) -> list[Codes]:
    every = {CAR: car, STATION: station, INTERACTION: _cell(car, station)}
    return [every[name] for name in names]


def _cell(car: Codes, station: Codes) -> Codes:
    return np.asarray(car * (int(np.max(station)) + 1) + station)


def _columns(codes: Codes) -> Array:
    """One column of zeros and ones for each level, (n, levels)."""
    return np.asarray(codes[:, None] == np.unique(codes)[None, :], dtype=np.float64)


def _adds(before: list[Codes], codes: Codes) -> bool:
    held = np.hstack([_columns(c) for c in before])
    both = np.hstack([held, _columns(codes)])
    return bool(np.linalg.matrix_rank(both) > np.linalg.matrix_rank(held))


def _new_directions(basis: Array, columns: Array) -> Array:
    """Orthonormal directions of ``columns`` that are not in ``basis``, (n, df)."""
    rest = columns - basis @ (basis.T @ columns)
    U, size, _ = np.linalg.svd(rest, full_matrices=False)
    return np.asarray(U[:, size > RANK * max(1.0, float(np.max(np.abs(columns).sum(axis=0))))])


def _trace(U: Array, Z: Array) -> float:
    """tr(U U' Z Z')."""
    return float(np.sum((U.T @ Z) ** 2))


def _effective_df(U: Array, Z: dict[str, Array], variances: dict[str, float]) -> float:
    """Satterthwaite's degrees of freedom of y' U U' y; negative ``variances`` count as zero.

    tr(M)^2 / tr(M^2) with M = U' V U: the number of directions if M is a multiple of 1.
    """
    M = sum(max(variances[n], 0.0) * (U.T @ z) @ (U.T @ z).T for n, z in Z.items())
    M = np.asarray(M)
    square = float(np.sum(M * M))
    return float(np.trace(M) ** 2 / square) if square > 0.0 else float(U.shape[1])
