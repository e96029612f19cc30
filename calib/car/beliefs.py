"""Priors of what is not measured, from `beliefs.csv`: each field here is a row there, or several.

Four groups: a `CAR`, a `SENSOR`, how one `LOG` differs from others, how a `STOP` differs from the
ramp. A quantity with two priors stands in two groups; the sources say why.
"""

from collections import Counter
from typing import Any, NamedTuple, TypeVar, get_type_hints

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.plain import rows

Row = dict[str, str]


class Belief(NamedTuple):
    """A normal prior, or a number where sigma is 0, in the unit of its row.

    ``model`` variance among cars of one model over that among all cars; ``tyre_file`` standard
    deviation of the value in a tyre file, by default ``sigma``.
    """

    mean: float
    sigma: float
    model: float = 1.0
    tyre_file: float = 0.0


STIFFENING, DRY_PEAK = 0.25, 0.9
"""ln of the tyres' stiffness on another road rises with this share of ln of its peak over that of
dry asphalt [1]; the rows `log_stiffness` are what varies beside it."""


class Mixture(NamedTuple):
    """A mixture of normal priors: each of its k ``cases`` has a relative share, mean and sigma."""

    cases: tuple[str, ...]
    share: Array
    mean: Array
    sigma: Array

    def case(self, u: Array) -> Index:
        """Index of the case (n,) that uniform numbers ``u`` (n,) draw."""
        ends = np.cumsum(self.share)
        return np.asarray(np.minimum(np.searchsorted(ends, u * ends[-1]), ends.size - 1))

    def is_case(self, name: str, u: Array) -> Mask:
        """Whether ``u`` (n,) draws the case ``name``. Raises ValueError for an unknown one."""
        return np.asarray(self.case(u) == self.cases.index(name))

    def drawn(self, u: Array, x: Array) -> Array:
        """Draw values (n,) by uniform ``u`` and standard normal ``x`` (n,)."""
        case = self.case(u)
        return np.asarray(self.mean[case] + self.sigma[case] * x)


class Car(NamedTuple):
    """A car, its tyres and its brakes; relative to the vehicle file where that has the value."""

    compliance: Belief
    log_tyre_ratio: Belief
    radius_load: Belief
    form: Belief
    load_exponent: Belief
    peak_load_exponent: Belief
    peak: Belief
    log_pad_ratio: Belief
    cg_to_front_axle: Belief
    cg_height: Belief
    form_length: Belief
    form_error_eta: Belief
    form_error_slip: Belief
    zero: Belief
    brake_lag: Belief
    log_slip: Belief
    pad_level: Belief


class Sensor(NamedTuple):
    """A sensor of any car."""

    a_x_scale: Belief
    a_x_offset: Belief


class Log(NamedTuple):
    """How one log differs from others of the same car."""

    pads_repeat: Belief
    a_x_scale: Belief
    a_x_scale_step: Belief


class Stop(NamedTuple):
    """How a stop may differ from the ramp, in cases."""

    log_pad_ratio: Mixture
    log_peak: Mixture
    log_stiffness: Mixture
    log_tyre: Mixture
    a_x_scale: Mixture
    a_x_offset: Mixture
    log_mass: Mixture


Group = TypeVar("Group", Car, Sensor, Log, Stop)


def beliefs_of(group: type[Group], table: list[Row]) -> Group:
    """The priors of a group, from the rows of `beliefs.csv`.

    Raises ValueError for a row without a field, a field without a row, a row that occurs twice, a
    quantity with two units, and a cell that is not a number.
    """
    kinds, lines = get_type_hints(group), [r for r in table if r["group"] == group.__name__.lower()]
    if unlike := kinds.keys() ^ {row["quantity"] for row in lines}:
        raise ValueError(f"a row without a field, or a field without a row: {', '.join(unlike)}")
    units = {(row["quantity"], row["unit"]) for row in table}
    if twice := [name for name, n in Counter(name for name, _ in units).items() if n > 1]:
        raise ValueError(f"two units of {', '.join(twice)}")
    read: dict[str, Any] = {}
    for name, kind in kinds.items():
        # in the order of their cases: no draw depends on the order of rows
        rows_of = sorted((r for r in lines if r["quantity"] == name), key=lambda row: row["case"])
        cases = tuple(row["case"] for row in rows_of)
        has_cases = kind is Mixture and all(cases) and len(set(cases)) == len(cases)
        if not (has_cases or (kind is Belief and cases == ("",))):
            raise ValueError(f"{name} is one row, or each of its rows a case of its own: {cases}")
        read[name] = _mixture(cases, rows_of) if has_cases else _belief(*rows_of)
    return group(**read)


def _belief(row: Row) -> Belief:
    mean, sigma = float(row["mean"]), float(row["sigma"])
    return Belief(mean, sigma, float(row["model"] or 1.0), float(row["tyre_file"] or sigma))


def _mixture(cases: tuple[str, ...], rows_of: list[Row]) -> Mixture:
    columns = ("share", "mean", "sigma")
    share, mean, sigma = (np.array([float(row[key]) for row in rows_of]) for key in columns)
    return Mixture(cases, share, mean, sigma)


_TABLE = rows("beliefs.csv", "calib.car")
if unknown := {row["group"] for row in _TABLE} - {"car", "sensor", "log", "stop"}:
    raise ValueError(f"unknown groups: {', '.join(unknown)}")
CAR, SENSOR = beliefs_of(Car, _TABLE), beliefs_of(Sensor, _TABLE)
LOG, STOP = beliefs_of(Log, _TABLE), beliefs_of(Stop, _TABLE)
