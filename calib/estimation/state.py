"""What the estimator is given of a block, and what it remembers."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Generic, NamedTuple, TypeVar

from calib.base.arrays import Array

Number = TypeVar("Number", float, Array)
"""Of one block, or of each of many (k,)."""


class Sample(NamedTuple, Generic[Number]):
    """Means over a block, SI."""

    demand: Number  # brake force that the deceleration demands, over the weight [1]
    nominal: Number  # that of nominal pads [1]
    pressure: Number  # the higher one [Pa]
    z: Number
    eta_less_1: Number  # as read [1]; eta is near 1, where float32 is coarse
    rim: Number  # speed of the front wheels' rims [m/s]
    rear_share: Number  # of the load [1]
    v: Number  # [m/s], NaN where not logged
    disturbed: Number  # number of a `Reason` while the car is steered or a wheel locks, else 0
    log_odds: Number  # ln of the front pressure over the rear one
    driven: Number  # 1 while the accelerator is pressed: thrust and slip are no zeros


@dataclass(slots=True)
class Zero:
    """What a signal reads while nothing brakes: a Gaussian that walks."""

    value: float
    variance: float


@dataclass(slots=True)
class LevelFilter:
    """Kalman filter of the brakes: states, then their variances and covariances."""

    level: float = 1.0  # of the pads [1]
    lag: float = 0.0  # of the brakes [s]
    rate: float = 0.0  # of the level [1/s]
    var_level: float = 0.0
    cov_level_lag: float = 0.0
    cov_level_rate: float = 0.0
    var_lag: float = 0.0
    cov_lag_rate: float = 0.0
    var_rate: float = 0.0


@dataclass(slots=True)
class SpeedFilter:
    """Kalman filter of the speed: states, then their variances and covariances."""

    v: float = 0.0  # above that of the rims [m/s]: a small number
    slip: float = 0.0  # ln(slip/z)
    offset: float = 0.0  # of a_x [1]
    scale: float = 0.0  # of a_x [1]
    var_v: float = 0.0
    cov_v_slip: float = 0.0
    cov_v_offset: float = 0.0
    cov_v_scale: float = 0.0
    var_slip: float = 0.0
    cov_slip_offset: float = 0.0
    cov_slip_scale: float = 0.0
    var_offset: float = 0.0
    cov_offset_scale: float = 0.0
    var_scale: float = 0.0


@dataclass(slots=True)
class Sums:
    """Sums over the blocks of a braking, which forget."""

    blocks: float = 0.0
    z: float = 0.0  # brake force that z demands, from its zero [1]
    shift: float = 0.0  # eta over its zero, less 1
    z_squared: float = 0.0


@dataclass(slots=True)
class State:
    """All that the estimator remembers."""

    demand: Zero
    eta_less_1: Zero
    slip: Zero
    level: LevelFilter = field(default_factory=LevelFilter)
    speed: SpeedFilter = field(default_factory=SpeedFilter)
    rim: float = 0.0  # of all wheels [m/s]
    anchored: bool = False  # once the speed no longer moves with the zero of eta
    waiting: deque[Sample[float]] = field(default_factory=deque)
    nominal: float = 0.0  # brake force of nominal pads over the weight [1]
    acting: float = 0.0  # the same behind the lag [1]
    by_lag: float = 0.0  # its slope by the lag [1/s]
    z: float = 0.0
    braked: float = 0.0  # time of this stop [s]
    released: float = 0.0  # [s]
    sums: Sums = field(default_factory=Sums)
    mean_z: float = 0.0
    innovation: float = 0.0
    # the best informed ratio and its change, their lower and upper bounds, variance by reading
    kept: Sequence[float] = (*(0.0,) * 2, *(-1e3,) * 2, *(1e3,) * 2, 0.0)
    age: float = 0.0  # of it [s]
    level_then: float = 1.0  # [1]
