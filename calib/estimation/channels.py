"""What an ECU reads and answers: the one order of both, in Python, in C and in an FMU."""

from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array, Index
from calib.base.plain import rows
from calib.logs.clock import GAP
from calib.logs.log import Log


class Variable(NamedTuple):
    """A number of an ECU, or of its FMU [SI]; a row of `variables.csv`, which lists them by order.

    A sensor that works reads ``low`` to ``high``. From sample to sample it changes by ``jump`` and
    ``rate`` times their distance in time [s] at most; what changes by more is an error of the bus.
    ``estimator`` and ``car`` its causality and variability in the FMU of either.
    """

    estimator: str
    car: str
    name: str
    unit: str
    meaning: str
    low: float
    high: float
    jump: float
    rate: float


def _read(row: dict[str, str]) -> Variable:
    estimator, car, name, unit, meaning, *numbers = row.values()
    return Variable(estimator, car, name, unit, meaning, *(float(x or "nan") for x in numbers))


VARIABLES = {x.name: x for x in map(_read, rows("variables.csv", "calib.estimation"))}
CHANNELS = {x.name: x for x in VARIABLES.values() if "input" in x.estimator}
"""What an ECU reads at one time; a sample (10,) has this order, in Python and in C."""

P_MC, A_X, FL, FR, RL, RR, STEERING, DRIVEN, *_ = range(len(CHANNELS))
OMEGA, DRIVE = slice(FL, RR + 1), slice(DRIVEN + 1, None)

REASON = VARIABLES.pop("reason")
ANSWERS = {x.name: x for x in VARIABLES.values() if "output" in x.estimator}
"""What is answered: (7, 3), each a median with its 95 % bounds, beside a `Reason`."""


_LONGEST_GAP = 10.0  # [s]: all but the zeros is forgotten by then


def rows_of(log: Log) -> Index:
    """The place (n,) of each sample of a log in `samples_of` it."""
    steps, most = np.diff(log.time) / log.sample_time, _LONGEST_GAP / log.sample_time
    missed = np.where(steps > GAP, np.round(np.minimum(steps, most)), 1.0)
    return np.append(0, np.cumsum(missed)).astype(np.intp)


def samples_of(log: Log) -> Array:
    """What an ECU would read in a log (m, 10), by `CHANNELS`: nothing, so NaN, in its gaps."""
    rows = rows_of(log)
    samples = np.full((rows[-1] + 1, len(CHANNELS)), np.nan)
    nothing = np.zeros_like(log.time)
    samples[rows] = np.stack([log.channels.get(name, nothing) for name in CHANNELS], axis=1)
    return samples


def limits(sample_time: float) -> tuple[Array, Array, Array]:
    """Low and high ends and largest changes of `CHANNELS` (10,) between calls [s]."""
    sensors = CHANNELS.values()
    low, high, jump, rate = np.array([(x.low, x.high, x.jump, x.rate) for x in sensors]).T
    return low, high, np.minimum(jump + rate * sample_time, high - low)
