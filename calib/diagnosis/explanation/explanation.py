"""An explanation of all logs: base, effects, a tyre's own form, what each log has of its own.

    state --predict--> innovations r      r + J dx + F df + N du      one linear model

The evidence is Laplace's about the state.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from calib.base.arrays import Array
from calib.car.disc_temperature import START
from calib.car.effects.effects import Effects
from calib.diagnosis.explanation.base import Base, Ground, form_covariance
from calib.diagnosis.explanation.channels import CHANNELS, residuals, whiten
from calib.diagnosis.explanation.gaussian import Marginal, Products
from calib.diagnosis.explanation.hypothesis import (
    Columns,
    Hypothesis,
    State,
    based,
    prior_precision,
)
from calib.diagnosis.explanation.own import FRONT_HEAT, OWN, REAR_HEAT, SLOPE, ZERO
from calib.diagnosis.explanation.predict import ObservedRun, predict
from calib.diagnosis.explanation.problem import Problem

_PRECISION = np.linalg.inv(form_covariance())

_BENT = 2.0
"""Mean square of pads and tyres, in standard deviations, from which they stand for an effect."""


@dataclass(frozen=True)
class Explanation:
    """A hypothesis fitted to the logs of a problem."""

    problem: Problem
    hypothesis: Hypothesis
    state: State
    innovations: list[Array]
    columns: Columns
    log_evidence: float = field(default=-np.inf)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its effects."""
        return self.hypothesis.names

    @property
    def count(self) -> int:
        """Number of innovations."""
        return sum(r.size for r in self.innovations)

    @property
    def reduced(self) -> float:
        """Mean squared innovation [1]."""
        return sum(float(r @ r) for r in self.innovations) / self.count

    @property
    def scatter(self) -> float:
        """Standard deviation of `reduced` where nothing is left [1].

        That of so many squares, and of the noise that they are held against.
        """
        freedom = len(CHANNELS) * self.problem.noise.freedom
        return math.sqrt(2.0 / self.count + 2.0 / freedom)

    @property
    def scaled_own(self) -> Array:
        """What each log has of its own, in standard deviations of the states that it may have."""
        S = self.hypothesis.sizes
        return np.asarray(self.state.own[:, S > 0.0] / S[S > 0.0])

    @property
    def strain(self) -> float:
        """Distance of the own states' squares from what their priors expect, in its scatter [1]."""
        own = self.scaled_own
        return float(np.sum(own**2) - own.size) / math.sqrt(2.0 * max(own.size, 1))

    @property
    def bent(self) -> bool:
        """Whether pads and tyres are far from usual ones, as if they stood for what is missing."""
        x = self.state.x[: self.problem.base_size] / self.problem.base_sigma
        far = float(x @ x + self.state.form @ _PRECISION @ self.state.form)
        return far > _BENT * (x.size + self.state.form.size)

    @property
    def base(self) -> Base:
        """Its base parameters, with the form of the tyres."""
        return based(self.problem, self.hypothesis, self.state)[0]

    @property
    def effects(self) -> Effects:
        """The known effects and its own, with its term."""
        return based(self.problem, self.hypothesis, self.state)[1]

    def with_x(self, x: Array) -> State:
        """The state with another x (m,)."""
        return replace(self.state, x=x)

    @cached_property
    def runs(self) -> list[ObservedRun]:
        """The runs with what each has of its own."""
        return runs_of(self.problem, self.state.own)

    @cached_property
    def products(self) -> list[Products]:
        """Inner products of each log."""
        return [self.products_of(i) for i in range(len(self.innovations))]

    def products_of(self, i: int, further: Array | None = None) -> Products:
        """Those of the log at ``i``, with ``further`` columns (c, n) behind its own."""
        shared = [self.columns.x[i], self.columns.form[i]]
        if further is not None:
            shared.append(further)
        own = own_columns(self, i)
        return Products.of(np.vstack(shared), own, self.innovations[i], self.state.own[i])

    def marginal(self) -> Marginal:
        """The linear model of all logs."""
        return marginal(self, self.products, self.hypothesis.sizes)

    @cached_property
    def covariance(self) -> Array:
        """Covariance (m, m) of x, forms and own states marginalised."""
        m = self.state.x.size
        return np.asarray(np.linalg.inv(self.marginal().information)[:m, :m])


def marginal(
    at: Explanation, products: list[Products], own: Array, damping: float = 0.0
) -> Marginal:
    """The linear model of all logs, shared and further columns as in ``products``.

    ``own`` (8,) standard deviations of what each log has of its own.
    """
    x, form = at.state.x, at.state.form
    from scipy.linalg import block_diag

    precision = block_diag(prior_precision(at.problem, at.hypothesis), _PRECISION)
    return Marginal.of(products, own, precision, np.concatenate([x, form]), damping)


def driven(run: ObservedRun, own: Array) -> ObservedRun:
    """The run with what it has of its own (8,)."""
    front = START + float(own[FRONT_HEAT])
    return replace(
        run,
        ground=Ground.of(own[:4]),
        slope=float(own[SLOPE]),
        zero=float(own[ZERO]),
        start_heat=(front, front + float(own[REAR_HEAT])),
    )


def innovations(problem: Problem, base: Base, effects: Effects, run: ObservedRun) -> Array:
    """Whitened residuals (n,) of a run, channel after channel."""
    return whiten(residuals(run, predict(problem.vehicle, base, effects, run)), problem.noise)


def of_all(
    problem: Problem, hypothesis: Hypothesis, state: State, runs: Sequence[ObservedRun] = ()
) -> list[Array]:
    """Innovations (n,) of each log; ``runs`` with what they have of their own, if at hand."""
    base, effects = based(problem, hypothesis, state)
    runs = runs or runs_of(problem, state.own)
    return [innovations(problem, base, effects, run) for run in runs]


def runs_of(problem: Problem, own: Array) -> list[ObservedRun]:
    """The runs with what each has of its ``own`` (runs, 8)."""
    return [driven(run, states) for run, states in zip(problem.runs, own, strict=True)]


def own_columns(at: Explanation, i: int) -> Array:
    """Derivatives (8, n) of the innovations of a log by what it has of its own."""
    r, J = at.innovations[i], at.columns.x[i]
    out = np.zeros((len(OWN), r.size))
    out[:4] = J[:4]  # pads, stiffness and peak are factors on those of the base
    out[[SLOPE, ZERO]] = at.problem.courses[i]
    out[[FRONT_HEAT, REAR_HEAT]] = at.columns.heat[i]
    return out


def objective(at: Explanation) -> float:
    """Sum of squares of the innovations and of all priors."""
    precision, own = prior_precision(at.problem, at.hypothesis), at.scaled_own
    x, f = at.state.x, at.state.form
    rows = sum(float(r @ r) for r in at.innovations)
    return float(rows + x @ precision @ x + f @ _PRECISION @ f + np.sum(own**2))
