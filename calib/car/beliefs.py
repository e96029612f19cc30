"""What is believed before anything is measured: `beliefs.csv`, each quantity once in a group.

A group is what a belief is of: a `CAR`, a `SENSOR`, what a `LOG` has of its own, what a `STOP`
may bring. Two values of one quantity stand in two groups, and their sources say why they differ. A
row that is no field here is an error, as is a field without a row.
"""

from typing import Any, NamedTuple, TypeVar, get_type_hints

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.plain import rows

Row = dict[str, str]


class Belief(NamedTuple):
    """A normal distribution, or one number where sigma is 0, in the unit of its row.

    Of cars: ``model`` is the share of the variance by which cars of one model are apart, 1 where
    the row says nothing; ``tyre_file`` the sigma of what a file of the tyre says, else that of any.
    """

    mean: float
    sigma: float
    model: float = 1.0
    tyre_file: float = 0.0


class Mixture(NamedTuple):
    """Normal distributions of which one holds.

    Names of the ``cases``; as arrays (k,) how often each happens, relative to the others, its mean
    and its sigma.
    """

    cases: tuple[str, ...]
    share: Array
    mean: Array
    sigma: Array

    def case(self, u: Array) -> Index:
        """The place of the case that holds (n,), by uniform numbers ``u`` (n,)."""
        ends = np.cumsum(self.share)
        return np.asarray(np.minimum(np.searchsorted(ends, u * ends[-1]), ends.size - 1))

    def is_case(self, name: str, u: Array) -> Mask:
        """Whether a case holds (n,). Raises ValueError for one that no row has."""
        return np.asarray(self.case(u) == self.cases.index(name))

    def drawn(self, u: Array, x: Array) -> Array:
        """Values (n,) by uniform ``u`` and standard normal ``x`` (n,)."""
        case = self.case(u)
        return np.asarray(self.mean[case] + self.sigma[case] * x)


class Car(NamedTuple):
    """A car, its tyres and its brakes, over the vehicle file where that has it."""

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
    """What one log has of its own."""

    pads_repeat: Belief
    a_x_scale: Belief
    a_x_scale_step: Belief


class Stop(NamedTuple):
    """What a stop may bring since the ramp, in cases."""

    log_pad_ratio: Mixture
    log_peak: Mixture
    log_stiffness: Mixture
    log_tyre: Mixture
    a_x_scale: Mixture
    a_x_offset: Mixture
    log_mass: Mixture


Group = TypeVar("Group", Car, Sensor, Log, Stop)


def beliefs_of(group: type[Group], table: list[Row]) -> Group:
    """The beliefs of a group in rows of `beliefs.csv`.

    Raises ValueError for a row that nobody reads, a quantity without a row, a row that is there
    twice, a quantity that has two units in the table, and a cell that is no number.
    """
    kinds, of = get_type_hints(group), [r for r in table if r["group"] == group.__name__.lower()]
    units = {(row["quantity"], row["unit"]) for row in table}
    for row in of:
        if row["quantity"] not in kinds:
            raise ValueError(f"nobody reads {row}; known are {', '.join(kinds)}")
        if len([unit for name, unit in units if name == row["quantity"]]) > 1:
            raise ValueError(f"two units of {row['quantity']}")
    read: dict[str, Any] = {}
    for name, kind in kinds.items():
        cases = [row for row in of if row["quantity"] == name]
        read[name] = _belief(name, cases) if kind is Belief else _mixture(name, cases)
    return group(**read)


def _belief(name: str, of: list[Row]) -> Belief:
    if [row["case"] for row in of] != [""]:
        raise ValueError(f"{name} is one row without a case, not {len(of)}: {of}")
    row, mean, sigma = of[0], float(of[0]["mean"]), float(of[0]["sigma"])
    return Belief(mean, sigma, float(row["model"] or 1.0), float(row["tyre_file"] or sigma))


def _mixture(name: str, of: list[Row]) -> Mixture:
    of = sorted(of, key=lambda row: row["case"])  # what is drawn hangs on no order of rows
    names = tuple(row["case"] for row in of)
    if not all(names) or len(set(names)) != len(of) or not of:
        raise ValueError(f"each row of {name} is a case of its own: {of}")
    share, mean, sigma = np.array([[float(r[k]) for k in ("share", "mean", "sigma")] for r in of]).T
    return Mixture(names, share, mean, sigma)


_TABLE = rows("beliefs.csv", "calib.car")
if strange := {row["group"] for row in _TABLE} - {"car", "sensor", "log", "stop"}:
    raise ValueError(f"groups that nobody reads: {', '.join(strange)}")
CAR, SENSOR = beliefs_of(Car, _TABLE), beliefs_of(Sensor, _TABLE)
LOG, STOP = beliefs_of(Log, _TABLE), beliefs_of(Stop, _TABLE)
