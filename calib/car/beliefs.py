"""Priors of quantities that are not measured, from `beliefs.csv`: there each has unit and source.

There are four groups: priors of a `Car`, of a `Sensor` of any car, of the difference between one
`Log` and others of the same car, and of the difference between a `Stop` and the ramp. A field of a
group is one row of the file, or several rows if it is a mixture.
"""

from typing import Any, NamedTuple, TypeVar, get_type_hints

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.plain import rows

Row = dict[str, str]


class Belief(NamedTuple):
    """A normal prior; a fixed number where ``sigma`` is 0."""

    mean: float
    sigma: float
    model: float = 1.0  # variance among cars of one model over the variance among all cars
    tyre_file: float = 0.0  # sigma of a value from a tyre file; ``sigma`` if the row has none


class Mixture(NamedTuple):
    """A mixture of k normal priors."""

    cases: tuple[str, ...]  # names of the priors
    share: Array  # of each prior, (k,); the sum need not be 1
    mean: Array  # (k,)
    sigma: Array  # (k,)

    def case(self, u: Array) -> Index:
        """Draw the index of a case (n,) by uniform random numbers ``u`` (n,)."""
        ends = np.cumsum(self.share)
        return np.asarray(np.minimum(np.searchsorted(ends, u * ends[-1]), ends.size - 1))

    def is_case(self, name: str, u: Array) -> Mask:
        """Whether ``u`` (n,) draws the case ``name``. Raises ValueError for an unknown name."""
        return np.asarray(self.case(u) == self.cases.index(name))

    def drawn(self, u: Array, x: Array) -> Array:
        """Draw values (n,) by uniform ``u`` and standard normal ``x``, (n,) each."""
        case = self.case(u)
        return np.asarray(self.mean[case] + self.sigma[case] * x)


STIFFENING, DRY_PEAK = 0.25, 0.9
"""On another road, where the tyre has the peak mu [1], STIFFENING ln(mu/DRY_PEAK) is added to
`log_stiffness`, which is ln of the slip stiffness over that on the ramp."""


class Car(NamedTuple):
    """Car, tyres and brakes; relative to the vehicle file for quantities that the file has."""

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
    """Return the priors of a group from the rows of `beliefs.csv`."""
    priors: dict[str, Any] = {}
    for name, kind in get_type_hints(group).items():
        key = (group.__name__.lower(), name)
        field_rows = [row for row in table if (row["group"], row["quantity"]) == key]
        priors[name] = _mixture(field_rows) if kind is Mixture else _belief(*field_rows)
    return group(**priors)


def _belief(row: Row) -> Belief:
    mean, sigma = float(row["mean"]), float(row["sigma"])
    return Belief(mean, sigma, float(row["model"] or 1.0), float(row["tyre_file"] or sigma))


def _mixture(field_rows: list[Row]) -> Mixture:
    ordered = sorted(field_rows, key=lambda row: row["case"])  # no draw depends on the file's order
    cases = tuple(row["case"] for row in ordered)
    keys = ("share", "mean", "sigma")
    return Mixture(cases, *(np.array([float(row[key]) for row in ordered]) for key in keys))


_TABLE = rows("beliefs.csv", "calib.car")
CAR, SENSOR = beliefs_of(Car, _TABLE), beliefs_of(Sensor, _TABLE)
LOG, STOP = beliefs_of(Log, _TABLE), beliefs_of(Stop, _TABLE)
