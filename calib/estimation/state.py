"""State of the step, and its input `Sample`. `calib.ecu.structures` makes the same classes in C."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Generic, NamedTuple, TypeVar

from calib.base.arrays import Array

Number = TypeVar("Number", float, Array)  # a number for one block, an array (k,) for many


class Sample(NamedTuple, Generic[Number]):
    """Means over a block, in SI units."""

    demand: Number  # brake force that the deceleration demands, over the weight [1]
    nominal: Number  # brake force of nominal pads, over the weight [1]
    pressure: Number  # higher one of the axles' pressures [Pa]
    z: Number  # deceleration [1]
    eta_less_1: Number  # eta - 1 [1] with its zero; minus 1, since float32 is coarse near 1
    rim: Number  # speed of the front wheels' rims [m/s]
    rear_share: Number  # share of the rear axle in the load [1]
    v: Number  # measured speed [m/s], NaN where not logged
    disturbed: Number  # number of a `Reason` while the car is steered or a wheel locks, else 0
    log_odds: Number  # ln of the front pressure over the rear pressure [1]
    driven: Number  # 1 while the accelerator is pressed: nothing is zeroed then
    drive: Number  # force of motors in the demand [1]
    eta_by_drive: Number  # added to eta by taking out drive and rolling resistance [1]


@dataclass(slots=True)
class Zero:
    """Mean and variance of a quantity that drifts: a zero, or the lag of the brakes."""

    value: float = 0.0
    variance: float = 0.0


@dataclass(slots=True)
class LevelFilter:
    """Kalman filter of the brakes; its third state, the lag, outlasts a stop and is in `State`."""

    level: float = 0.0  # of the pads [1]
    rate: float = 0.0  # of the level [1/s]
    var_level: float = 0.0
    cov_level_lag: float = 0.0
    cov_level_rate: float = 0.0
    cov_lag_rate: float = 0.0
    var_rate: float = 0.0


@dataclass(slots=True)
class SpeedFilter:
    """Kalman filter of the speed: states, then their variances and covariances."""

    v: float = 0.0  # speed of the car less that of the rims [m/s]: a small number
    slip: float = 0.0  # ln(slip/z) [1]
    offset: float = 0.0  # offset of a_x over g [1]
    scale: float = 0.0  # relative excess of a_x while braking [1]
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
class Means:
    """Means over the blocks of a braking, in which older blocks count less."""

    blocks: float = 0.0  # effective number of blocks; 0 before any braking
    z: float = 0.0  # brake force y = `Sample.demand` less its zero [1]
    eta_rise: float = 0.0  # eta over its zero, less 1 [1]
    z_squared: float = 0.0  # square of y [1]
    eta_by_drive: float = 0.0  # as in `Sample`


@dataclass(slots=True)
class Check:
    """Evidence of the innovations: whether brakes, a_x, a motor or ABS are their cause."""

    level: float = 0.0  # level of the pads before it changed by a step [1]
    error: float = 0.0  # brake force that this level does not explain [1]: an error of a_x?
    v: float = 0.0  # errors of the states of `SpeedFilter`, if a_x is wrong by `error`
    slip: float = 0.0
    offset: float = 0.0
    scale: float = 0.0
    ratio: float = 0.0  # log likelihood ratio of an error of a_x over none
    drive: float = 0.0  # mean of the force of motors, which forgets [1]
    chatter: float = 0.0  # mean of the squared innovations of the brake force, which forgets
    refused: float = 0.0  # number of implausible zeros in a row
    failing: float = 0.0  # `CHECKS` that fail now, one bit each
    failed: float = 0.0  # `CHECKS` that failed last, one bit each
    since: float = 0.0  # time since a check failed last [s]


@dataclass(slots=True)
class State:
    """All that the estimator remembers."""

    demand: Zero = field(default_factory=Zero)  # zero of `Sample.demand` [1]
    eta_less_1: Zero = field(default_factory=Zero)  # zero of `Sample.eta_less_1` [1]
    lag: Zero = field(default_factory=Zero)  # time constant of the brakes [s]
    zero_slip: Zero = field(default_factory=Zero)  # slip without brakes, where v is logged [1]
    level: LevelFilter = field(default_factory=LevelFilter)
    speed: SpeedFilter = field(default_factory=SpeedFilter)
    check: Check = field(default_factory=Check)
    rim: float = 0.0  # speed of the rims of all wheels [m/s]
    anchored: bool = False  # whether a_x predicts the speed; else it is that of the rims
    errs: bool = False  # whether a_x is wrong, by the innovations
    waiting: deque[Sample[float]] = field(default_factory=deque)  # blocks that may show zeros
    nominal: float = 0.0  # brake force of nominal pads over the weight [1]
    acting: float = 0.0  # brake force of nominal pads behind the lag, over the weight [1]
    by_lag: float = 0.0  # derivative of `acting` by the lag [1/s]
    z: float = 0.0  # deceleration of the last block [1]
    braked: float = 0.0  # time of this stop [s]
    released: float = 0.0  # time since the brakes were released [s]
    means: Means = field(default_factory=Means)
    mean_z: float = 0.0  # mean of z in `means`, at least `Constants.least_mean_z` [1]
    share: float = 0.0  # share of the pressure that acts, the rest lags [1]
    innovation: float = 0.0  # innovation of the wheel speeds, in standard deviations
    checks: float = 0.0  # `CHECKS` that fail or just failed, one bit each

    # The held ratio: ln of the ratio, and of its change since the ramp; the lower bounds of ratio
    # and change; their upper bounds; the variance of the ratio by errors of eta and slip.
    held_ratio: Sequence[float] = (0.0, 0.0, -1e3, -1e3, 1e3, 1e3, 0.0)
    age: float = 0.0  # age of the held ratio [s]
    level_then: float = 0.0  # level at which the ratio was read [1]
