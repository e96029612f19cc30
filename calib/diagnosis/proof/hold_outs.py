"""The hold-outs, seen in both ways: step by step as innovations, and replayed open loop."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from calib.base.errors import ModelError
from calib.car.effects.effects import Effects
from calib.car.model import Model
from calib.car.vehicle import Vehicle
from calib.diagnosis.explanation.base import BASE, Base, Ground, base_of
from calib.diagnosis.explanation.candidate import Candidate
from calib.diagnosis.explanation.offsets import as_effects, offset_between
from calib.diagnosis.explanation.predict import ObservedRun, run_of, wheel_angles
from calib.diagnosis.explanation.problem import Problem, turned_to_ripple
from calib.diagnosis.explanation.vector import bounds, unpack
from calib.diagnosis.proof.remainder import Remainder, apart_from_parameters, remainder_of
from calib.diagnosis.search import groups, heats
from calib.logs.log import Log
from calib.model.replay import replay


@dataclass(frozen=True)
class HoldOuts:
    """The logs that are held out, and the same as a ``problem`` with the noise of calibration."""

    logs: tuple[Log, ...]
    problem: Problem

    def replayed(self, candidate: Candidate) -> tuple[Log, ...]:
        """Every log replayed open loop. Raises ModelError if a replay cannot be computed."""
        self.problem.tell("proving on the hold-outs", 0, 1)
        return self.replays(candidate.base, candidate.effects)

    def replays(self, base: Base, effects: Effects) -> tuple[Log, ...]:
        """Every log replayed on its ground and with its own offset.

        Ripples follow the measured angle of the wheels.
        """
        own = self.problem.offsets(base, effects)
        grounds = self.problem.grounds(base, effects)
        first = self._driven(base, effects, own, grounds)
        if not own:
            return first
        # errors of one step say less of an offset than what a whole replay gathers
        pairs = zip(first, self.logs, strict=True)
        left = [offset_between(self.problem.offset, sim, log) for sim, log in pairs]
        own = [a + b for a, b in zip(own, left, strict=True)]
        return self._driven(base, effects, own, grounds)

    def _driven(
        self, base: Base, effects: Effects, own: Sequence[float], grounds: Sequence[Ground]
    ) -> tuple[Log, ...]:
        """Every log replayed on its ground, with an offset of its ``own`` if there are any."""
        out = []
        for i, (log, run) in enumerate(zip(self.logs, self.problem.runs, strict=True)):
            acts = effects.with_(as_effects(self.problem.offset, own[i])) if own else effects
            model = _model(self.problem.vehicle, grounds[i].applied(base), acts)
            out.append(
                replay(model, log, wheel_angle=_angles_of(log, run), start_heat=run.start_heat)
            )
        return tuple(out)

    def seen_with(self, candidate: Candidate) -> Candidate:
        """The candidate as the hold-outs see it, its parameters as they are."""
        innovations = self.problem.flat(candidate.base, candidate.effects)
        return replace(
            candidate,
            problem=self.problem,
            chi2=float(innovations @ innovations),
            count=innovations.size,
        )

    def left(self, candidate: Candidate, replayed: Sequence[Log]) -> Remainder:
        """What remains with a candidate, beyond noise and the errors of its parameters."""
        return remainder_of(replayed, self.logs, lambda: self._moved(candidate))

    def left_at_best(self, candidate: Candidate, replayed: Sequence[Log]) -> Remainder:
        """What remains with the parameters that their errors allow and the replays like best."""
        return apart_from_parameters(replayed, self.logs, lambda: self._moved(candidate))

    def _moved(self, candidate: Candidate) -> list[tuple[Log, ...]]:
        """Replays with the parameters moved by one standard deviation along each direction."""
        values, vectors = np.linalg.eigh(candidate.covariance)
        scaled = vectors * np.sqrt(np.maximum(values, 0.0) * max(candidate.reduced, 1.0))
        low, high = bounds(self.problem, candidate.names)
        points = [np.clip(candidate.x + direction, low, high) for direction in scaled.T]
        moved = partial(_replays_at, replace(self, problem=self.problem.alone), candidate.names)
        return [replays for replays in self.problem.mapped(moved, points) if replays is not None]


def _replays_at(
    held: HoldOuts, names: tuple[str, ...], x: NDArray[np.float64]
) -> tuple[Log, ...] | None:
    """Replays at a vector of parameters; None where they cannot be computed."""
    try:
        return held.replays(*unpack(held.problem, names, x))
    except ModelError:
        return None


def hold_outs_of(at: Candidate, logs: Sequence[Log]) -> HoldOuts:
    """The hold-outs of a candidate's problem, with its noise, on the ground and heat that fit."""
    problem = at.problem
    nominal = base_of(problem.vehicle, np.zeros(BASE))
    runs = [turned_to_ripple(problem.vehicle, nominal, run_of(log), problem.noise) for log in logs]
    placed = heats.placed(problem, groups.placed(problem, runs, at), at)
    return HoldOuts(tuple(logs), replace(problem, runs=placed))


def _angles_of(log: Log, run: ObservedRun) -> dict[str, NDArray[np.float64]]:
    """Measured angle of the wheels [rad] (n,) by axle, from the origin that its run was given.

    Only a sensor's angle is fed in, no torque and no speed: what turns with the wheels alone is
    helped by it.
    """
    angle = wheel_angles(log)
    first = np.mean(angle["f"][: round(run.step / log.sample_time)])  # as `run_of` averages it
    return {"f": angle["f"] + (run.angle_f[0] - first), "r": angle["r"]}


def model_of(vehicle: Vehicle, candidate: Candidate) -> Model:
    """A candidate as a model that can be simulated."""
    return _model(vehicle, candidate.base, candidate.effects)


def _model(vehicle: Vehicle, base: Base, effects: Effects) -> Model:
    return Model(
        vehicle=vehicle.with_radii(base.radius),
        pad_friction_f=base.pad_friction_f,
        pad_friction_r=base.pad_friction_r,
        tyre=base.tyre,
        effects=effects,
        surfaces=(),
    )
