"""An explanation as a model has it, and the replays of the hold-outs with it."""

from dataclasses import dataclass, replace

import numpy as np

from calib.base.arrays import Array
from calib.diagnosis.explanation.columns import columns_by_own
from calib.diagnosis.explanation.explanation import Explanation, of_all
from calib.diagnosis.explanation.fit import SETTLED, fit
from calib.diagnosis.explanation.gaussian import Products
from calib.diagnosis.explanation.hypothesis import State
from calib.diagnosis.explanation.own import OWN, sizes
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.replays.hold_outs import HoldOuts
from calib.logs.log import Log


@dataclass(frozen=True)
class Replayed:
    """An explanation, and the same without a departure of its tyre, ``at``, as a model has it.

    ``own`` (runs, 8) of the hold-outs, ``logs`` their replays.
    """

    of: Explanation
    at: Explanation
    own: Array
    logs: tuple[Log, ...]


def replayed(held: HoldOuts, at: Explanation, settled: float = SETTLED) -> Replayed:
    """Fit an explanation as a model has it, and replay the hold-outs. Raises ModelError."""
    plain = without_form(at, settled)
    own = placed(held.problem, plain)
    return Replayed(at, plain, own, held.replays(plain.base, plain.effects, own))


def without_form(at: Explanation, settled: float = SETTLED) -> Explanation:
    """The same hypothesis, with tyres that do not depart from their form."""
    state = replace(at.state, form=np.zeros_like(at.state.form))
    hypothesis = replace(at.hypothesis, departs=False)
    return fit(at.problem, hypothesis, state, at.columns, settled)


def placed(held: Problem, at: Explanation) -> Array:
    """What each hold-out has of its own, (runs, 8), of the kinds in which the logs differ."""
    own = np.zeros((len(held.runs), len(OWN)))
    if not at.hypothesis.kinds:
        return own
    S = np.where(sizes(at.hypothesis.kinds) != sizes(()), sizes(at.hypothesis.kinds), 0.0)
    which = np.flatnonzero(S)
    for _ in range(3):
        state = State(at.state.x, at.state.form, own)
        r = of_all(held, at.hypothesis, state)
        columns = columns_by_own(held, at.hypothesis, state, r, which.tolist())
        for one, N, states in zip(r, columns, own, strict=True):
            products = Products.of(np.zeros((0, one.size)), N, one, states[which])
            states[which] -= products.reduced(S[which])[1][:, -1]
    return own
