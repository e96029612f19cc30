"""The hold-outs replayed open loop, and the gap between replay and measurement.

    fit --replayed--> replays with and without the effects --gap_of--> Gap before and after

A replay uses the pressures, the first speed, logged torques of motors and temperatures of discs,
and, for a ripple alone, the angle of the wheels. So an error of force, which an innovation of one
step hides, adds up in v. The gap is the mean square of replay less measurement, less the variance
of the noise, so that a perfect model has no gap.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from calib.base.arrays import Array
from calib.base.intervals import noise_over
from calib.base.names import WHEELS
from calib.car.effects.effects import Effects
from calib.car.model import Model
from calib.car.vehicle import Vehicle
from calib.diagnosis.explanation.fit import Fit, random_derivatives, runs_of
from calib.diagnosis.explanation.gauss_newton import fit_logs
from calib.diagnosis.explanation.gaussian import Products
from calib.diagnosis.explanation.hypothesis import State
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.explanation.unknowns import RANDOM_EFFECTS, SLOPE, ZERO, Base
from calib.logs.log import Log
from calib.model.simulate import replay

UNITS = {"a_x": "m/s^2", **{f"omega_{w}": "rad/s" for w in WHEELS}, "v": "m/s"}
CHANNELS = tuple(UNITS)  # of a replay

_LONGEST_LAG = 0.2
"""Longest time [s] between two samples whose difference shows noise: twice the correlation time of
the noise that a road makes. In it the car hardly moves."""
_LARGEST_RATIO = 2.0**0.5
"""Largest ratio of the noise to that from sample to sample: half of the variance of a road's noise
is too slow for neighbouring samples. A larger ratio comes from motion, such as a ripple."""
_INTERPOLATED_RATIO = 7.0
"""Ratio of the noise over up to four samples to that from sample to sample above which a channel
was interpolated by straight lines. A ripple of ten times the noise has a ratio of 4."""
_FLOOR = np.where(np.array(CHANNELS) == "v", 0.003, 0.005)
"""Least noise (6,) of the channels, in their units: no car is described to better than that."""
_ROUNDS = 3  # most Gauss-Newton steps to the random effects of the hold-outs
_NEAR = 1.0  # step [standard deviations] within which the linear model holds


@dataclass(frozen=True, eq=False)
class Gap:
    """The gap of every log and channel, without and with effects."""

    logs: tuple[str, ...]
    noise: Array  # standard deviations of the channels, in their units (6,)
    squares: Array  # gap over the variance of the noise, at least 0 [1] (2, logs, 6)

    def rms(self, log: str | None = None, channel: str | None = None) -> tuple[float, float]:
        """Rms before and after in units of the noise, of one log or all, one channel or all."""
        rows = [i for i, name in enumerate(self.logs) if log in (None, name)]
        columns = [j for j, name in enumerate(CHANNELS) if channel in (None, name)]
        squares = self.squares[:, rows][:, :, columns]
        rms_before, rms_after = np.sqrt(np.mean(squares, axis=(1, 2))).tolist()
        return rms_before, rms_after

    @property
    def rms_before(self) -> float:
        """Rms of all logs and channels without the effects, in units of the noise."""
        return self.rms()[0]

    @property
    def rms_after(self) -> float:
        """Rms of all logs and channels with the effects, in units of the noise."""
        return self.rms()[1]

    @property
    def closed(self) -> float:
        """Share of the gap that the effects close [1]; 0 where there is no gap."""
        rms_before, rms_after = self.rms()
        return 1.0 - rms_after / rms_before if rms_before > 0.0 else 0.0


def gap_of(
    replays_before: Sequence[Log], replays_after: Sequence[Log], measured: Sequence[Log]
) -> Gap:
    """Compare replays with their logs up to the end of the shorter one: a replay ends at 1 m/s."""
    noise = noises_of(measured)
    mean_squares = [
        [_mean_squares(*pair) for pair in zip(replays, measured, strict=True)]
        for replays in (replays_before, replays_after)
    ]
    squares = np.maximum(np.array(mean_squares) / noise**2 - 1.0, 0.0)
    return Gap(tuple(log.name for log in measured), noise, squares)


def _mean_squares(replay: Log, measured: Log) -> list[float]:
    """Mean squares (6,) of replay less measurement, over their common samples."""
    n = min(replay.time.size, measured.time.size)
    return [float(np.mean((replay[c][:n] - measured[c][:n]) ** 2)) for c in CHANNELS]


def noises_of(measured: Sequence[Log]) -> Array:
    """Standard deviation of the noise of every channel (6,): the median of the logs."""
    by_log = [[_noise_of(log, channel) for channel in CHANNELS] for log in measured]
    return np.maximum(np.median(by_log, axis=0), _FLOOR)


def _noise_of(log: Log, channel: str) -> float:
    """Standard deviation of the noise of a channel, in its unit, from third differences.

    The noise is the largest over any lag, but at most `_LARGEST_RATIO` times that from sample to
    sample. A channel that was interpolated by straight lines shows little noise from sample to
    sample, so this limit does not hold for it.
    """
    # third differences of white noise have 20 times its variance
    from_sample_to_sample = float(np.std(np.diff(log[channel], 3)) / np.sqrt(20.0))
    by_lag = noise_over(log[channel], _LONGEST_LAG / log.sample_time)  # robust, of 1, 2, 4 ...
    by_lag = [from_sample_to_sample, *by_lag]
    is_interpolated = max(by_lag[:4]) > _INTERPOLATED_RATIO * from_sample_to_sample
    if channel in log.interpolated or is_interpolated:
        return max(by_lag)
    return min(max(by_lag), _LARGEST_RATIO * from_sample_to_sample)


@dataclass(frozen=True)
class HoldOuts:
    """The held-out ``logs``, and their ``problem`` with the noise of the calibration logs."""

    logs: tuple[Log, ...]
    problem: Problem

    def replays(self, fit: Fit, random_effects: Array) -> tuple[Log, ...]:
        """Replay every log open loop with its ``random_effects`` (runs, 8). Raises ModelError."""
        replays = []
        for log, run in zip(self.logs, runs_of(self.problem, random_effects), strict=True):
            slope, zero = run.random_effects[[SLOPE, ZERO]].tolist()
            offsets: dict[str, dict[str, float]] = {}
            if slope:
                offsets["road_grade"] = {"grade": slope, "felt": 1.0}
            if zero:
                offsets["accelerometer_bias"] = {"bias": zero}
            effects = fit.effects.with_(Effects(offsets))
            model = model_of(self.problem.vehicle, fit.base.of_log(run.random_effects), effects)
            pairs = (("f", run.angle_f), ("r", run.angle_r))
            angles = {axle: np.interp(log.time, run.time, angle) for axle, angle in pairs}
            replays.append(replay(model, log, wheel_angle=angles, start_heat=run.start_heat))
        return tuple(replays)


def model_of(vehicle: Vehicle, base: Base, effects: Effects) -> Model:
    """Base and effects as a model that can be simulated; its tyre has no discrepancy."""
    rolling = vehicle.with_radii(base.radius)
    return Model(rolling, base.pad_friction_f, base.pad_friction_r, base.tyre, effects)


@dataclass(frozen=True)
class Replayed:
    """A fit, and replays of the hold-outs with and without its effects."""

    fit: Fit
    simulated: Fit  # the same hypothesis without tyre discrepancies, which no simulation has
    base: Fit  # without effects and discrepancies
    random_effects: Array  # of the hold-outs, by ``simulated`` (runs, 8)
    base_logs: tuple[Log, ...]  # replays of ``base`` with these random effects
    logs: tuple[Log, ...]  # replays of ``simulated`` with them


def replayed(holdouts: HoldOuts, fit: Fit, base: Fit | None) -> Replayed:
    """Fit again without tyre discrepancies, and replay the hold-outs with and without effects.

    ``base`` is without effects and discrepancies, or None if ``fit`` has no effects. Raises
    ModelError if a replay fails.
    """
    simulated = without_discrepancy(fit)
    random_effects = holdout_effects(holdouts.problem, simulated)
    logs = holdouts.replays(simulated, random_effects)
    if base is None:
        return Replayed(fit, simulated, simulated, random_effects, logs, logs)
    base_logs = holdouts.replays(base, random_effects)
    return Replayed(fit, simulated, base, random_effects, base_logs, logs)


def without_discrepancy(fit: Fit) -> Fit:
    """Fit the same hypothesis with tyres whose slip does not depart from its formula."""
    state = replace(fit.state, discrepancy=np.zeros_like(fit.state.discrepancy))
    hypothesis = replace(fit.hypothesis, has_discrepancy=False)
    return fit_logs(fit.problem, hypothesis, state, fit.columns)


def holdout_effects(holdouts: Problem, fit: Fit) -> Array:
    """Fit the random effects (runs, 8) of the hold-outs, all else as in ``fit``."""
    S = fit.hypothesis.sigmas
    places = np.flatnonzero(S)
    random_effects = np.zeros((len(holdouts.runs), len(RANDOM_EFFECTS)))
    for _ in range(_ROUNDS):
        state = State(fit.state.x, fit.state.discrepancy, random_effects)
        present = replace(fit, problem=holdouts).at_state(state)
        columns, previous = random_derivatives(present, places.tolist()), random_effects.copy()
        for i, (r, N) in enumerate(zip(present.innovations, columns, strict=True)):
            products = Products.from_columns(np.zeros((0, r.size)), N, r, previous[i, places])
            _, step, _ = products.marginalised(S[places])
            random_effects[i, places] -= step[:, -1]
        if np.all(np.abs(random_effects - previous) <= _NEAR * S):
            break
    return random_effects
