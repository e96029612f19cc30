"""The hold-outs, seen in both ways: step by step as innovations, and replayed open loop."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calib.diagnosis.candidate import (
    Candidate,
    Problem,
    base_of,
    bounds,
    turned_to_ripple,
    unpack,
)
from calib.diagnosis.gap import replays
from calib.diagnosis.predict import SHAPE, Base, run_of
from calib.diagnosis.remainder import Remainder, remainder_of
from calib.errors import ModelError
from calib.logs.log import Log
from calib.physics.effects.effects import Effects
from calib.physics.magic_formula import MagicFormula
from calib.physics.model import Model
from calib.physics.vehicle import Vehicle


@dataclass(frozen=True)
class HoldOuts:
    """The logs that are held out, and the same as a ``problem`` with the noise of calibration."""

    logs: tuple[Log, ...]
    problem: Problem

    def replayed(self, candidate: Candidate) -> tuple[Log, ...]:
        """Every log replayed open loop. Raises ModelError if a replay cannot be computed."""
        return tuple(replays(model_of(self.problem.vehicle, candidate), self.logs))

    def left(self, candidate: Candidate, replayed: Sequence[Log]) -> Remainder:
        """What remains with a candidate, beyond noise and the errors of its parameters."""
        return remainder_of(replayed, self.logs, lambda: self._moved(candidate))

    def _moved(self, candidate: Candidate) -> list[tuple[Log, ...]]:
        """Replays with the parameters moved by one standard deviation along each direction."""
        values, vectors = np.linalg.eigh(candidate.covariance)
        scaled = vectors * np.sqrt(np.maximum(values, 0.0) * max(candidate.reduced, 1.0))
        low, high = bounds(self.problem.vehicle, candidate.names)
        out = []
        for direction in scaled.T:
            x = np.clip(candidate.x + direction, low, high)
            base, effects = unpack(self.problem.vehicle, candidate.names, x)
            try:
                out.append(tuple(replays(_model(self.problem.vehicle, base, effects), self.logs)))
            except ModelError:
                continue  # what cannot be replayed explains nothing
        return out


def hold_outs_of(problem: Problem, logs: Sequence[Log]) -> HoldOuts:
    """The hold-outs of a problem, with its noise."""
    nominal = base_of(problem.vehicle, np.zeros(4))
    runs = [turned_to_ripple(problem.vehicle, nominal, run_of(log), problem.noise) for log in logs]
    return HoldOuts(tuple(logs), Problem(problem.vehicle, tuple(runs), problem.noise))


def model_of(vehicle: Vehicle, candidate: Candidate) -> Model:
    """A candidate as a model that can be simulated."""
    return _model(vehicle, candidate.base, candidate.effects)


def _model(vehicle: Vehicle, base: Base, effects: Effects) -> Model:
    return Model(
        vehicle=vehicle,
        pad_friction_f=base.pad_friction_f,
        pad_friction_r=base.pad_friction_r,
        tyre=MagicFormula(base.stiffness, base.peak, SHAPE),
        effects=effects,
        surfaces=(),
    )
