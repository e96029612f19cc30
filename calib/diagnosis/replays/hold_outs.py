"""The hold-outs, seen in both ways: step by step as innovations, and replayed open loop."""

from dataclasses import dataclass, replace

import numpy as np

from calib.base.arrays import Array
from calib.car.effects.effects import Effects
from calib.car.model import Model
from calib.car.vehicle import Vehicle
from calib.diagnosis.explanation.base import Base
from calib.diagnosis.explanation.columns import columns_by_own
from calib.diagnosis.explanation.explanation import Explanation, of_all, runs_of
from calib.diagnosis.explanation.fit import SETTLED, fit
from calib.diagnosis.explanation.gaussian import Products
from calib.diagnosis.explanation.hypothesis import State
from calib.diagnosis.explanation.own import GRADE, OWN, SLOPE, ZERO, ZERO_OF_A_X
from calib.diagnosis.explanation.problem import Problem
from calib.logs.log import Log
from calib.model.simulate import replay

_ROUNDS = 3  # in which hold-outs are placed, at most
_NEAR = 1.0  # step, in standard deviations, after which a linear model holds


@dataclass(frozen=True)
class HoldOuts:
    """The logs that are held out, and the same as a ``problem`` with the noise of calibration."""

    logs: tuple[Log, ...]
    problem: Problem

    def replays(self, at: Explanation, own: Array) -> tuple[Log, ...]:
        """Every log replayed open loop with what it has of its ``own`` (runs, 8).

        Ripples follow the angle of the wheels, which a sensor measured: no torque and no speed is
        fed in, so what turns with the wheels alone is helped by it. Raises ModelError if it cannot
        be computed.
        """
        out = []
        for log, run in zip(self.logs, runs_of(self.problem, own), strict=True):
            slope, zero = run.own[[SLOPE, ZERO]].tolist()
            acts = {GRADE: {"grade": slope, "felt": 1.0}} if slope else {}
            acts |= {ZERO_OF_A_X: {"bias": zero}} if zero else {}
            model = model_of(
                self.problem.vehicle, at.base.of_log(run.own), at.effects.with_(Effects(acts))
            )
            angles = {
                axle: np.interp(log.time, run.time, x)
                for axle, x in (("f", run.angle_f), ("r", run.angle_r))
            }
            out.append(replay(model, log, wheel_angle=angles, start_heat=run.start_heat))
        return tuple(out)


def model_of(vehicle: Vehicle, base: Base, effects: Effects) -> Model:
    """Base and effects as a model that can be simulated, without a departure of its tyre."""
    rolling = vehicle.with_radii(base.radius)
    return Model(rolling, base.pad_friction_f, base.pad_friction_r, base.tyre, effects)


@dataclass(frozen=True)
class Replayed:
    """An explanation, and ``at`` and ``base``, the same and the one without effects, as a model
    has them: without a departure of the tyre.

    ``own`` (runs, 8) of the hold-outs, ``logs`` their replays, ``before`` those of the base, with
    the same pads and roads, so that effects alone make the difference.
    """

    of: Explanation
    at: Explanation
    base: Explanation
    own: Array
    before: tuple[Log, ...]
    logs: tuple[Log, ...]


def replayed(
    held: HoldOuts, at: Explanation, base: Explanation, settled: float = SETTLED
) -> Replayed:
    """Fit an explanation as a model has it, and replay the hold-outs. Raises ModelError.

    ``base`` is the one without effects, as a model has it.
    """
    plain = without_form(at, settled)
    own = placed(held.problem, plain)
    logs = held.replays(plain, own)
    if not at.names and at.hypothesis.walk is None:
        return Replayed(at, plain, plain, own, logs, logs)
    return Replayed(at, plain, base, own, held.replays(base, own), logs)


def without_form(at: Explanation, settled: float = SETTLED) -> Explanation:
    """The same hypothesis, with tyres that do not depart from their form."""
    state = replace(at.state, form=np.zeros_like(at.state.form))
    hypothesis = replace(at.hypothesis, departs=False)
    return fit(at.problem, hypothesis, state, at.columns, settled)


def placed(held: Problem, at: Explanation) -> Array:
    """What each hold-out has of its own, (runs, 8), of all that logs may differ in."""
    S = at.hypothesis.sizes
    own, which = np.zeros((len(held.runs), len(OWN))), np.flatnonzero(S)
    for _ in range(_ROUNDS):
        state = State(at.state.x, at.state.form, own)
        r = of_all(held, at.hypothesis, state)
        there = replace(at, problem=held, state=state, innovations=r)
        columns, before = columns_by_own(there, which.tolist()), own.copy()
        for one, N, states in zip(r, columns, own, strict=True):
            products = Products.of(np.zeros((0, one.size)), N, one, states[which])
            states[which] -= products.reduced(S[which])[1][:, -1]
        if np.all(np.abs(own - before) <= _NEAR * S):
            break
    return own
