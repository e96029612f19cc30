"""The hold-outs, seen in both ways: step by step as innovations, and replayed open loop."""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.car.effects.effects import Effects
from calib.car.model import Model
from calib.car.vehicle import Vehicle
from calib.diagnosis.explanation.base import Base
from calib.diagnosis.explanation.explanation import runs_of
from calib.diagnosis.explanation.own import GRADE, SLOPE, ZERO, ZERO_OF_A_X
from calib.diagnosis.explanation.predict import ObservedRun
from calib.diagnosis.explanation.problem import Problem
from calib.logs.log import Log
from calib.model.replay import replay


@dataclass(frozen=True)
class HoldOuts:
    """The logs that are held out, and the same as a ``problem`` with the noise of calibration."""

    logs: tuple[Log, ...]
    problem: Problem

    def replays(self, base: Base, effects: Effects, own: Array) -> tuple[Log, ...]:
        """Every log replayed open loop with what it has of its ``own`` (runs, 8).

        Ripples follow the angle of the wheels, which a sensor measured: no torque and no speed is
        fed in, so what turns with the wheels alone is helped by it. Raises ModelError if it cannot
        be computed.
        """
        out = []
        for log, run in zip(self.logs, runs_of(self.problem, own), strict=True):
            acts = effects.with_(_of_log(run))
            model = model_of(self.problem.vehicle, base.of_log(run.own), acts)
            angles = {"f": run.angle_f, "r": run.angle_r}
            angles = {axle: np.interp(log.time, run.time, x) for axle, x in angles.items()}
            out.append(replay(model, log, wheel_angle=angles, start_heat=run.start_heat))
        return tuple(out)


def _of_log(run: ObservedRun) -> Effects:
    """Slope of the road and zero of the accelerometer of one log, as effects of its car."""
    own, slope, zero = {}, float(run.own[SLOPE]), float(run.own[ZERO])
    if slope:
        own[GRADE] = {"grade": slope, "felt": 1.0}
    if zero:
        own[ZERO_OF_A_X] = {"bias": zero}
    return Effects(own)


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
