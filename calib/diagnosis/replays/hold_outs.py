"""The hold-outs, seen in both ways: step by step as innovations, and replayed open loop."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ModelError
from calib.car.effects.effects import Effects
from calib.car.model import Model
from calib.car.vehicle import Vehicle
from calib.diagnosis.explanation.base import Base
from calib.diagnosis.explanation.explanation import Explanation, runs_of
from calib.diagnosis.explanation.hypothesis import Hypothesis, State, based, bounds_of
from calib.diagnosis.explanation.own import GRADE, ZERO_OF_A_X
from calib.diagnosis.explanation.predict import ObservedRun, wheel_angles
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.replays.remainder import Remainder, remainder_of
from calib.logs.log import Log
from calib.model.replay import replay


@dataclass(frozen=True)
class HoldOuts:
    """The logs that are held out, and the same as a ``problem`` with the noise of calibration."""

    logs: tuple[Log, ...]
    problem: Problem

    def replays(self, base: Base, effects: Effects, own: Array) -> tuple[Log, ...]:
        """Every log replayed open loop with what it has of its ``own`` (runs, 8).

        Ripples follow the measured angle of the wheels. Raises ModelError if it cannot be computed.
        """
        out = []
        for log, run in zip(self.logs, runs_of(self.problem, own), strict=True):
            acts = effects.with_(_of_log(run))
            model = model_of(self.problem.vehicle, run.ground.applied(base), acts)
            angles = _angles_of(log, run)
            out.append(replay(model, log, wheel_angle=angles, start_heat=run.start_heat))
        return tuple(out)

    def left(self, at: Explanation, own: Array, replayed: Sequence[Log]) -> Remainder:
        """What remains with an explanation, beyond noise and the errors of its parameters."""
        return remainder_of(replayed, self.logs, lambda: self._moved(at, own))

    def _moved(self, at: Explanation, own: Array) -> list[tuple[Log, ...]]:
        """Replays with the parameters moved by one standard deviation along each direction."""
        values, vectors = np.linalg.eigh(at.covariance)
        scaled = vectors * np.sqrt(np.maximum(values, 0.0) * max(at.reduced, 1.0))
        low, high = bounds_of(self.problem, at.hypothesis)
        points = [at.with_x(np.clip(at.state.x + direction, low, high)) for direction in scaled.T]
        alone = replace(self, problem=self.problem.alone)
        moved = partial(_replays_at, alone, at.hypothesis, own)
        return [replays for replays in self.problem.mapped(moved, points) if replays is not None]


def _replays_at(
    held: HoldOuts, hypothesis: Hypothesis, own: Array, state: State
) -> tuple[Log, ...] | None:
    """Replays of a hypothesis at a state; None where they cannot be computed."""
    try:
        return held.replays(*based(held.problem, hypothesis, state), own)
    except ModelError:
        return None


def _of_log(run: ObservedRun) -> Effects:
    """Slope of the road and zero of the accelerometer of one log, as effects of its car."""
    own = {}
    if run.slope:
        own[GRADE] = {"grade": run.slope, "felt": 1.0}
    if run.zero:
        own[ZERO_OF_A_X] = {"bias": run.zero}
    return Effects(own)


def _angles_of(log: Log, run: ObservedRun) -> dict[str, Array]:
    """Measured angle of the wheels [rad] (n,) by axle, from the origin that its run was given.

    Only a sensor's angle is fed in, no torque and no speed: what turns with the wheels alone is
    helped by it.
    """
    angle = wheel_angles(log)
    first = np.mean(angle["f"][: round(run.step / log.sample_time)])  # as `run_of` averages it
    return {"f": angle["f"] + (run.angle_f[0] - first), "r": angle["r"]}


def model_of(vehicle: Vehicle, base: Base, effects: Effects) -> Model:
    """Base and effects as a model that can be simulated, without a departure of its tyre."""
    return Model(
        vehicle=vehicle.with_radii(base.radius),
        pad_friction_f=base.pad_friction_f,
        pad_friction_r=base.pad_friction_r,
        tyre=base.tyre,
        effects=effects,
        surfaces=(),
    )
