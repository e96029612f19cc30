"""A hypothesis at a state: its predictions of all logs, innovations and derivatives.

    state --predict--> innovations r      r + J dx + F df + N du      one linear model

x has base parameters, effects and the values of a term, f the discrepancies of the tyres, u the
random effects of a log. J, F and N are the columns, by finite differences. The evidence is that of
the linear model (Laplace's approximation).
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import repeat
from typing import Self

import numpy as np

from calib.base.arrays import Array
from calib.car.effects.effects import Effects
from calib.diagnosis.explanation import unknowns
from calib.diagnosis.explanation.channels import CHANNELS, of_wheels, residuals, whiten
from calib.diagnosis.explanation.gaussian import Marginal, Products
from calib.diagnosis.explanation.hypothesis import (
    FADE,
    Hypothesis,
    Prior,
    State,
    base_and_effects,
    prior_of,
)
from calib.diagnosis.explanation.predict import ObservedRun, Prediction, RunLag, predict
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.explanation.unknowns import DISCREPANCY_FORCES, RANDOM_EFFECTS, Base

_UNUSUAL = 2.0  # mean square of an unusual base and discrepancy over that of their priors [1]
_STEP = 1e-3  # step of an element of x in a finite difference [1]
_STEP_OF_RANDOM = 1.0 / 15.0  # the same of a random effect, over its largest standard deviation


@dataclass(frozen=True)
class Fit:
    """A hypothesis fitted to the logs of a problem; the lists have one item for each log."""

    problem: Problem
    hypothesis: Hypothesis
    state: State
    predictions: list[Prediction]
    innovations: list[Array]  # (n,)
    columns: list[Array]  # derivatives of the innovations by x and discrepancy (m + 2 k, n)
    further_columns: list[Array]  # derivatives by slope, zero, front heat and rear heat (4, n)
    log_evidence: float = -np.inf

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return self.hypothesis.names

    @property
    def count(self) -> int:
        """Number of innovations."""
        return sum(r.size for r in self.innovations)

    @property
    def mean_square(self) -> float:
        """Mean squared innovation [1]; 1 if only noise is left."""
        return sum(float(r @ r) for r in self.innovations) / self.count

    @property
    def scatter(self) -> float:
        """Standard deviation of `mean_square` [1] if only noise of an estimated size is left."""
        freedom = len(CHANNELS) * self.problem.noise.freedom
        return math.sqrt(2.0 / self.count + 2.0 / freedom)

    @cached_property
    def prior(self) -> Prior:
        """Prior of x and discrepancy."""
        return prior_of(self.problem, self.hypothesis)

    @property
    def scaled_random_effects(self) -> Array:
        """Random effects over their standard deviations (runs, j), where these are not 0."""
        S = self.hypothesis.sigmas
        return np.asarray(self.state.random_effects[:, S > 0.0] / S[S > 0.0])

    @cached_property
    def squares(self) -> float:
        """Sum of squares of the innovations and of all priors."""
        shared = self.state.shared
        of_innovations = sum(float(r @ r) for r in self.innovations)
        of_prior = shared @ self.prior.precision @ shared
        return float(of_innovations + of_prior + np.sum(self.scaled_random_effects**2))

    @property
    def random_effects_excess(self) -> float:
        """Sum of squares of the random effects less its expected value, over its scatter [1]."""
        u = self.scaled_random_effects
        return float(np.sum(u**2) - u.size) / math.sqrt(2.0 * max(u.size, 1))

    @property
    def has_unusual_base(self) -> bool:
        """Whether pads and tyres are far from usual ones, as if they stood for a missing effect."""
        is_base = self.prior.effect_names == ""
        base = np.where(is_base, self.state.shared, 0.0)
        return bool(base @ self.prior.precision @ base > _UNUSUAL * np.sum(is_base))

    def worth_of(self, name: str) -> float:
        """Gain of ln of the evidence by an effect in the linear model, without its price."""
        i = int(np.argmax(self.prior.effect_names == name))  # place of its strength
        return float(0.5 * self.state.x[i] ** 2 / self.covariance[i, i])

    @property
    def for_worker(self) -> Self:
        """The fit without columns, for a worker process that only predicts."""
        return replace(self, problem=self.problem.for_worker, columns=[], further_columns=[])

    @property
    def base(self) -> Base:
        """Base parameters, with the discrepancies of the tyres."""
        return base_and_effects(self.problem, self.hypothesis, self.state)[0]

    @property
    def effects(self) -> Effects:
        """Effects of the vehicle file and of the hypothesis, with its empirical term."""
        return base_and_effects(self.problem, self.hypothesis, self.state)[1]

    @cached_property
    def runs(self) -> list[ObservedRun]:
        """The runs with their random effects."""
        return runs_of(self.problem, self.state.random_effects)

    @property
    def lags(self) -> list[RunLag]:
        """Lag of the wheels of each run, for predictions nearby."""
        return [prediction.lag for prediction in self.predictions]

    def at_state(self, state: State) -> Self:
        """Return the fit at another state, with the columns of the present one."""
        predictions, r = predict_all(self.problem, self.hypothesis, state)
        return replace(self, state=state, predictions=predictions, innovations=r)

    def random_columns(self, i: int) -> Array:
        """Derivatives (8, n) of the innovations of log ``i`` by its random effects."""
        derivatives = np.empty((len(RANDOM_EFFECTS), self.innovations[i].size))
        derivatives[unknowns.NO_FACTORS] = self.further_columns[i]
        # a factor acts as the base parameter that it multiplies
        derivatives[unknowns.FACTORS] = self.columns[i][unknowns.MULTIPLIED]
        return derivatives

    def products_with(self, further: Sequence[Array]) -> list[Products]:
        """Inner products of each log, with its ``further`` columns (c, n) after the shared ones."""
        products = []
        for i, r in enumerate(self.innovations):
            shared = np.vstack([self.columns[i], further[i]])
            u = self.state.random_effects[i]
            products.append(Products.from_columns(shared, self.random_columns(i), r, u))
        return products

    @cached_property
    def products(self) -> list[Products]:
        """Inner products of each log."""
        return self.products_with([np.zeros((0, r.size)) for r in self.innovations])

    def marginal(
        self,
        products: list[Products] | None = None,
        sigmas: Array | None = None,
        damping: float = 0.0,
    ) -> Marginal:
        """The linear model of the logs whose ``products`` are given, by default of all logs.

        ``sigmas`` (8,) of the random effects are by default those of the hypothesis. For
        ``damping`` see `Products.marginalised`.
        """
        return Marginal.from_products(
            self.products if products is None else products,
            self.hypothesis.sigmas if sigmas is None else sigmas,
            self.prior.precision,
            self.state.shared,
            damping,
        )

    @cached_property
    def covariance(self) -> Array:
        """Covariance (m, m) of x; discrepancies and random effects are marginalised."""
        m = self.state.x.size
        return np.asarray(np.linalg.inv(self.marginal().information)[:m, :m])


def innovations(
    problem: Problem, base: Base, effects: Effects, run: ObservedRun, lag: RunLag | None = None
) -> Array:
    """Whitened residuals (n,) of a run, channel after channel; ``lag`` as for `predict`."""
    prediction = predict(problem.vehicle, base, effects, run, lag)
    return whiten(residuals(run, prediction), problem.noise)


def predict_all(
    problem: Problem,
    hypothesis: Hypothesis,
    state: State,
    lags: Iterable[RunLag | None] = repeat(None),
) -> tuple[list[Prediction], list[Array]]:
    """Prediction and innovations (n,) of each log; ``lags`` as for `predict`."""
    base, effects = base_and_effects(problem, hypothesis, state)
    runs = runs_of(problem, state.random_effects)
    predictions = [
        predict(problem.vehicle, base, effects, run, lag)
        for run, lag in zip(runs, lags, strict=False)
    ]
    differences = map(residuals, problem.runs, predictions)
    return predictions, [whiten(r, problem.noise) for r in differences]


def runs_of(problem: Problem, random_effects: Array) -> list[ObservedRun]:
    """Return the runs with these ``random_effects`` (runs, 8)."""
    return [run.with_random_effects(u) for run, u in zip(problem.runs, random_effects, strict=True)]


def linearised(
    problem: Problem, hypothesis: Hypothesis, state: State, near: Sequence[Array] = ()
) -> Fit:
    """Return a hypothesis at a state, with its columns; ``near`` as for `with_columns`."""
    predictions, r = predict_all(problem, hypothesis, state)
    return with_columns(Fit(problem, hypothesis, state, predictions, r, [], []), near)


def with_columns(fit: Fit, near: Sequence[Array] = ()) -> Fit:
    """Return the fit with the columns of its state, by differences.

    ``near`` are columns of each log at a state nearby, which may have fewer elements of x. The
    columns by these elements and by the discrepancy are then taken from ``near``.
    """
    state, m, size = fit.state, fit.state.x.size, fit.state.discrepancy.size  # size is 2 k
    reused = len(near[0]) - size if near else 0  # number of elements of x that ``near`` has
    steps = np.where(state.x + _STEP < fit.prior.high[:m], _STEP, -_STEP)
    moved = [replace(state, x=state.x + step) for step in np.diag(steps)[reused:]]
    computed = _differences(fit, moved, steps[reused:])
    reusable = near if near else _by_discrepancy(fit)  # the columns by the discrepancy are the last
    columns = []
    for J_reused, J in zip(reusable, computed, strict=True):
        by_discrepancy = J_reused[-size:]
        if not fit.hypothesis.has_discrepancy:
            by_discrepancy = np.zeros_like(by_discrepancy)
        columns.append(np.vstack([J_reused[:reused], J, by_discrepancy]))
    if FADE in fit.effects:
        heat = random_derivatives(fit, (unknowns.FRONT_HEAT, unknowns.REAR_HEAT))
    else:
        heat = [np.zeros((2, r.size)) for r in fit.innovations]
    pairs = zip(fit.problem.offset_columns, heat, strict=True)
    return replace(fit, columns=columns, further_columns=[np.vstack(pair) for pair in pairs])


def _by_discrepancy(fit: Fit) -> list[Array]:
    """Derivatives (2 k, n) of the innovations of each log by front and rear discrepancy."""
    derivatives, hats = [], np.eye(DISCREPANCY_FORCES.size)
    is_front = np.array([[True], [True], [False], [False]])  # by wheel
    for run, prediction in zip(fit.problem.runs, fit.predictions, strict=True):
        forces = prediction.normalised_force
        shares = np.stack(  # (k, 4, n): a value acts with a hat function of the force
            [[np.interp(force, DISCREPANCY_FORCES, hat) for force in forces] for hat in hats]
        )
        # predicted wheel speeds fall with a discrepancy, so residuals rise
        rise = shares * prediction.slip_speed
        omega = np.concatenate([np.where(is_front, rise, 0.0), np.where(is_front, 0.0, rise)])
        derivatives.append(whiten(of_wheels(run, omega), fit.problem.noise))
    return derivatives


def random_derivatives(fit: Fit, places: Sequence[int]) -> list[Array]:
    """Derivatives (j, n) of the innovations of each log by its random effects at ``places``."""
    steps, u = _STEP_OF_RANDOM * unknowns.random_sigmas(unknowns.GROUPS), fit.state.random_effects
    moved = [replace(fit.state, random_effects=u + np.diag(steps)[place]) for place in places]
    return _differences(fit, moved, steps[list(places)])


def _differences(fit: Fit, moved: Sequence[State], steps: Array) -> list[Array]:
    """Derivatives (j, n) of the innovations of each log from j ``moved`` states, by ``steps``."""
    moved_r = [predict_all(fit.problem, fit.hypothesis, state, fit.lags)[1] for state in moved]
    return [  # reshape, since j may be 0
        (np.array([of_logs[i] for of_logs in moved_r]).reshape(-1, r.size) - r) / steps[:, None]
        for i, r in enumerate(fit.innovations)
    ]
