"""The states of the split filter by name: what each is, how it starts, how it may drift.

The level says what both axles brake together; the states say how it is split, and hold all that
could be mistaken for a change of the split.
"""

import math
from collections.abc import Sequence
from typing import Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from calib.estimation.priors import Priors
from calib.model.parameters import PRIORS
from calib.table.table import TyrePosterior

Array = NDArray[np.float64]
T = TypeVar("T")


class States(NamedTuple, Generic[T]):
    """One thing for each state, by the state's name, in the filter's order."""

    log_pad_ratio: T  # ln of the pads' ratio front over rear, relative to nominal
    log_stiffness: T  # ln of the surface's stiffness relative to the table's
    log_peak_ratio: T  # ln of the table's peak over the surface's
    load_shift: T  # load moved otherwise than by the pitch mode, over the weight
    elastic_share: T  # share of the load transfer that follows the body's pitch mode
    pitch_tempo: T  # ln of the mode's frequency over the usual one
    eta_zero: T  # zero of eta: radii of this day
    slip_zero: T  # zero of the mean slip, likewise
    clock_offset: T  # clock offset between v and the wheels
    load_exponent: T  # the table's tyre, `calib.car.tyre`
    log_compliance: T
    curvature_2: T
    curvature_3: T
    table_log_pad_ratio: T  # the ratio of the pads on the day of the ramp
    log_tyre_ratio: T  # the table's tyres, rear over front
    radius_load: T  # share by which a radius falls when its load doubles
    tyre_change: T  # ln of the tyres' ratio, what has changed since the ramp
    slip_delay: T  # time by which the slip follows the pressure


class State(NamedTuple):
    """How a state starts and moves.

    ``symbol`` in the equations; ``start`` its mean, None where the table's posterior gives it;
    ``sigma`` around it, what the posterior says not counted; ``drift`` random walk, per sqrt(s).
    """

    symbol: str
    unit: str
    start: float | None
    sigma: float
    drift: float


def state_list(p: Priors) -> States[State]:
    """Every state with its numbers.

    Two states hang on others. ``log_peak_ratio`` also moves with the stiffness, by
    ``peak_per_stiffness``. ``load_shift`` is a Gauss-Markov process: it decays with
    ``pitch_memory`` and is fed by what `calib.estimation.filter_input` says of each block.
    """
    # fmt: off
    return States(
        #                           symbol   unit start            sigma            drift/sqrt(s)
        log_pad_ratio       = State("rho",   "1", None,            p.ratio,         p.drift_ratio),
        log_stiffness       = State("s",     "1", 0.0,             p.stiffness,     p.drift_road),
        log_peak_ratio      = State("w",     "1", 0.0,             p.peak,          p.drift_road),
        load_shift          = State("xi",    "1", 0.0,             0.0,             0.0),
        elastic_share       = State("kappa", "1", p.elastic_share, p.elastic_sigma, 0.0),
        pitch_tempo         = State("nu",    "1", 0.0,             p.pitch_tempo,   0.0),
        eta_zero            = State("eta0",  "1", 0.0,             p.zero,          p.drift_zero),
        slip_zero           = State("sl0",   "1", 0.0,             p.zero,          p.drift_zero),
        clock_offset        = State("lag",   "s", None,            0.0,             0.0),
        load_exponent       = State("q",     "1", None,            0.0,             0.0),
        log_compliance      = State("c",     "1", None,            0.0,             0.0),
        curvature_2         = State("b2",    "1", None,            0.0,             0.0),
        curvature_3         = State("b3",    "1", None,            0.0,             0.0),
        table_log_pad_ratio = State("rho0",  "1", None,            0.0,             0.0),
        log_tyre_ratio      = State("tau",   "1", None,            0.0,             0.0),
        radius_load         = State("r",     "1", None,            0.0,             0.0),
        tyre_change         = State("dtau",  "1", 0.0,             p.tyre_change,   0.0),
        slip_delay          = State("delta", "s", p.delay,         p.delay_sigma,   0.0),
    )
    # fmt: on


COUNT = len(States._fields)

AT = States[int](*range(COUNT))
"""The place of each state in vectors and matrices."""


def places(names: Sequence[str]) -> list[int]:
    """Return the places of the states that the parameters of a table's posterior are.

    The ratio of the posterior is that of the ramp's pads, not of today's.
    """
    own = {"log_pad_ratio": "table_log_pad_ratio"}
    return [States._fields.index(own.get(name, name)) for name in names]


def first_state(posterior: TyrePosterior, priors: Priors) -> tuple[Array, Array]:
    """State (COUNT,) and covariance (COUNT, COUNT) before the stop, from the table's posterior.

    Without its scatter, from which no stop learns: `first_scatter`.
    """
    rows = state_list(priors)
    x = np.array([row.start or 0.0 for row in rows])
    P = np.zeros((COUNT, COUNT))
    table = places(posterior.names)
    x[table], P[np.ix_(table, table)] = posterior.mean, posterior.covariance
    if posterior.scatter:
        P[np.ix_(table, table)] -= np.asarray(posterior.scatter)
    for name, prior in PRIORS._asdict().items():  # of an older table, as a ramp begins with it
        if name not in posterior.names:
            place = States._fields.index(name)
            x[place], P[place, place] = prior.mean, prior.sigma**2
    # the pads of today: the table's ratio, and free around it
    x[AT.log_pad_ratio] = x[AT.table_log_pad_ratio]
    today_as_then(P)
    P[np.diag_indices(COUNT)] += np.array([row.sigma for row in rows]) ** 2
    couple_surface(P, priors.peak_per_stiffness, priors.stiffness)
    return x, P


def first_scatter(posterior: TyrePosterior) -> Array:
    """A root A (COUNT, m) of the table's scatter before the stop, A A' its covariance.

    One column for each of the m directions in which the table has a scatter.
    """
    if not posterior.scatter:
        return np.zeros((COUNT, 0))
    at, scatter = places(posterior.names), np.asarray(posterior.scatter)
    sigma = np.sqrt(np.diag(scatter))
    unit = np.where(sigma > 0.0, sigma, 1.0)
    size, direction = np.linalg.eigh(scatter / np.outer(unit, unit))
    counted = size > 1e-9 * size[-1]
    A = np.zeros((COUNT, np.count_nonzero(counted)))
    A[at] = unit[:, None] * direction[:, counted] * np.sqrt(size[counted])
    A[AT.log_pad_ratio] = A[AT.table_log_pad_ratio]
    return A


def today_as_then(P: Array) -> None:
    """Make the pads' ratio of today that of the ramp, in a covariance, in place."""
    today, then = AT.log_pad_ratio, AT.table_log_pad_ratio
    P[today, :] = P[then, :]
    P[:, today] = P[:, then]
    P[today, today] = P[then, then]


def open_surface(P: Array, priors: Priors, share: float) -> None:
    """Add to a covariance, in place, a ``share`` [1] of the spread of a surface nobody knows."""
    P[AT.log_stiffness, AT.log_stiffness] += (share * priors.stiffness) ** 2
    P[AT.log_peak_ratio, AT.log_peak_ratio] += (share * priors.peak) ** 2
    couple_surface(P, priors.peak_per_stiffness, share * priors.stiffness)


def changed_surface(length: float, priors: Priors) -> float:
    """Share of `open_surface` for each block of ``length`` [s] after a change of the surface."""
    return priors.change_rate * math.sqrt(length)


def couple_surface(P: Array, slope: float, stiffness: float) -> None:
    """Add to a covariance, in place, that the peak moves with the stiffness.

    ``slope`` d log_peak_ratio/d log_stiffness; ``stiffness`` the part of the sigma of log_stiffness
    that it moves with, which P already holds.
    """
    s, w, variance = AT.log_stiffness, AT.log_peak_ratio, stiffness**2
    P[s, w] += slope * variance
    P[w, s] += slope * variance
    P[w, w] += slope**2 * variance
