"""A hypothesis fitted to all logs: base, effects, shape of the tyre, random effects of each log.

    state --predict--> innovations r      r + J dx + F df + N du      one linear model

The evidence is Laplace's about the state; derivatives are finite differences.
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
from calib.diagnosis.explanation.base import (
    COURSES,
    FACTOR_ON,
    FORM_AT,
    FRONT_HEAT,
    HEATS,
    KINDS,
    NAMES,
    OWN,
    REAR_HEAT,
    Base,
    sizes,
)
from calib.diagnosis.explanation.channels import CHANNELS, of_wheels, residuals, whiten
from calib.diagnosis.explanation.gaussian import Marginal, Products
from calib.diagnosis.explanation.hypothesis import FADE, Hypothesis, Prior, State, based, prior_of
from calib.diagnosis.explanation.predict import ObservedRun, Prediction, RunLag, predict
from calib.diagnosis.explanation.problem import Problem

_BENT = 2.0  # mean square of pads and tyres over their priors' from which they are bent [1]
_STEP = 1e-3  # of an element of x [1]
_STEP_OF_OWN = 1.0 / 15.0  # of a random effect, over its largest standard deviation


@dataclass(frozen=True)
class Fit:
    """A hypothesis fitted to the logs of a problem.

    Of each log its ``predictions``, its ``innovations`` (n,), and their derivatives: ``columns``
    (m + 2 k, n) by x and the form of tyres, ``further_columns`` (4, n) by its slope, zero of a_x,
    and first heats of its discs.
    """

    problem: Problem
    hypothesis: Hypothesis
    state: State
    predictions: list[Prediction]
    innovations: list[Array]
    columns: list[Array]
    further_columns: list[Array]
    log_evidence: float = -np.inf

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
        """Standard deviation of `reduced` where nothing is left [1], with that of the noise."""
        freedom = len(CHANNELS) * self.problem.noise.freedom
        return math.sqrt(2.0 / self.count + 2.0 / freedom)

    @cached_property
    def prior(self) -> Prior:
        """The prior of all that logs share."""
        return prior_of(self.problem, self.hypothesis)

    @property
    def scaled_random_effects(self) -> Array:
        """Random effects of each log in their standard deviations, those that it may have."""
        S = self.hypothesis.sizes
        return np.asarray(self.state.random_effects[:, S > 0.0] / S[S > 0.0])

    @cached_property
    def squares(self) -> float:
        """Sum of squares of the innovations and of all priors."""
        shared, rows = self.state.shared, sum(float(r @ r) for r in self.innovations)
        return float(
            rows + shared @ self.prior.precision @ shared + np.sum(self.scaled_random_effects**2)
        )

    @property
    def random_effects_excess(self) -> float:
        """Sum of squares of the random effects beyond the expected one, in its scatter [1]."""
        random_effects = self.scaled_random_effects
        return float(np.sum(random_effects**2) - random_effects.size) / math.sqrt(
            2.0 * max(random_effects.size, 1)
        )

    @property
    def has_unusual_base(self) -> bool:
        """Whether pads and tyres are far from usual ones, as where they imitate what is missing."""
        shared = np.where(self.prior.effect_names == "", self.state.shared, 0.0)
        return bool(
            shared @ self.prior.precision @ shared > _BENT * np.sum(self.prior.effect_names == "")
        )

    def worth_of(self, name: str) -> float:
        """ln of the evidence that an effect gains, without its price, by a linear step."""
        i = int(np.argmax(self.prior.effect_names == name))
        return float(0.5 * self.state.x[i] ** 2 / self.covariance[i, i])

    @property
    def alone(self) -> Self:
        """The same without columns, for a worker process that only predicts."""
        return replace(self, problem=self.problem.alone, columns=[], further_columns=[])

    @property
    def base(self) -> Base:
        """Base parameters, with the form of the tyres."""
        return based(self.problem, self.hypothesis, self.state)[0]

    @property
    def effects(self) -> Effects:
        """Effects of the vehicle file and of the hypothesis, with its term."""
        return based(self.problem, self.hypothesis, self.state)[1]

    @cached_property
    def runs(self) -> list[ObservedRun]:
        """The runs with their random effects."""
        return runs_of(self.problem, self.state.random_effects)

    @property
    def lags(self) -> list[RunLag]:
        """How the wheels of each run follow, for predictions nearby."""
        return [made.lag for made in self.predictions]

    def moved(self, state: State) -> Self:
        """The same at another state, with the columns of this one."""
        predictions, r = of_all(self.problem, self.hypothesis, state)
        return replace(self, state=state, predictions=predictions, innovations=r)

    def random_columns(self, i: int) -> Array:
        """Derivatives (8, n) of a log by its random effects: by a factor as by what it is on."""
        further_columns = dict(zip((*COURSES, *HEATS), self.further_columns[i], strict=True))
        factors = {name: self.columns[i][NAMES.index(on)] for name, on in FACTOR_ON.items()}
        return np.stack([(factors | further_columns)[name] for name in OWN])

    def products_with(self, further: Sequence[Array]) -> list[Products]:
        """Inner products of each log, with ``further`` columns (c, n) behind the shared ones."""
        return [
            Products.from_columns(np.vstack([J, more]), self.random_columns(i), r, random_effects)
            for i, (J, more, r, random_effects) in enumerate(
                zip(self.columns, further, self.innovations, self.state.random_effects, strict=True)
            )
        ]

    @cached_property
    def products(self) -> list[Products]:
        """Inner products of each log."""
        return self.products_with([np.zeros((0, r.size)) for r in self.innovations])

    def marginal(
        self,
        products: list[Products] | None = None,
        sizes: Array | None = None,
        damping: float = 0.0,
    ) -> Marginal:
        """The linear model of all logs, or of these ``products``, with columns behind or not.

        ``sizes`` (8,) standard deviations of the random effects, if not those of the hypothesis.
        """
        sizes = self.hypothesis.sizes if sizes is None else sizes
        products = products or self.products
        return Marginal.from_products(
            products, sizes, self.prior.precision, self.state.shared, damping
        )

    @cached_property
    def covariance(self) -> Array:
        """Covariance (m, m) of x; forms and random effects are marginalised."""
        m = self.state.x.size
        return np.asarray(np.linalg.inv(self.marginal().information)[:m, :m])


def innovations(
    problem: Problem, base: Base, effects: Effects, run: ObservedRun, lag: RunLag | None = None
) -> Array:
    """Whitened residuals (n,) of a run, channel after channel; ``lag`` as for `predict`."""
    prediction = predict(problem.vehicle, base, effects, run, lag)
    return whiten(residuals(run, prediction), problem.noise)


def of_all(
    problem: Problem,
    hypothesis: Hypothesis,
    state: State,
    lags: Iterable[RunLag | None] = repeat(None),
) -> tuple[list[Prediction], list[Array]]:
    """Prediction and innovations (n,) of each log."""
    base, effects = based(problem, hypothesis, state)
    runs = runs_of(problem, state.random_effects)
    predictions = [
        predict(problem.vehicle, base, effects, run, lag)
        for run, lag in zip(runs, lags, strict=False)
    ]
    differences = map(residuals, problem.runs, predictions)
    return predictions, [whiten(r, problem.noise) for r in differences]


def runs_of(problem: Problem, random_effects: Array) -> list[ObservedRun]:
    """The runs with these ``random_effects`` (runs, 8)."""
    return [
        run.with_random_effects(states)
        for run, states in zip(problem.runs, random_effects, strict=True)
    ]


def linearised(
    problem: Problem, hypothesis: Hypothesis, state: State, near: Sequence[Array] = ()
) -> Fit:
    """Return a hypothesis at a state, with its columns; see `with_columns`."""
    predictions, r = of_all(problem, hypothesis, state)
    return with_columns(Fit(problem, hypothesis, state, predictions, r, [], []), near)


def with_columns(fit: Fit, near: Sequence[Array] = ()) -> Fit:
    """Return the same with the columns of its state, by differences.

    ``near`` are columns of each log at a state nearby: those by the first elements of x and, last,
    by the form are taken from there.
    """
    state, m, k = fit.state, fit.state.x.size, fit.state.form.size
    first = len(near[0]) - k if near else 0
    steps = np.where(state.x + _STEP < fit.prior.high[:m], _STEP, -_STEP)
    moved = [replace(state, x=state.x + step) for step in np.diag(steps)[first:]]
    J = _differences(fit, moved, steps[first:])
    form = near or _by_form(fit)
    parts = zip(near or form, J, form, strict=True)
    J = [np.vstack([a[:first], b, fit.hypothesis.has_discrepancy * c[-k:]]) for a, b, c in parts]
    if FADE in fit.effects:
        heat = random_columns_of(fit, (FRONT_HEAT, REAR_HEAT))
    else:
        heat = [np.zeros((2, r.size)) for r in fit.innovations]
    further_columns = [np.vstack(both) for both in zip(fit.problem.courses, heat, strict=True)]
    return replace(fit, columns=J, further_columns=further_columns)


def _by_form(fit: Fit) -> list[Array]:
    """Derivatives (2 k, n) of the innovations of each log by the form of front and rear tyres."""
    derivatives, hats = [], np.eye(FORM_AT.size)
    for run, prediction in zip(fit.problem.runs, fit.predictions, strict=True):
        shares = np.stack(
            [[np.interp(use, FORM_AT, hat) for use in prediction.use] for hat in hats]
        )
        omega = np.stack([shares * prediction.lost] * 2)
        omega[0, :, 2:], omega[1, :, :2] = 0.0, 0.0
        derivatives.append(whiten(of_wheels(run, np.concatenate(omega)), fit.problem.noise))
    return derivatives


def random_columns_of(fit: Fit, states: Sequence[int]) -> list[Array]:
    """Derivatives of the innovations of each log by some of its random effects, by their places."""
    steps = _STEP_OF_OWN * sizes(KINDS)
    moved = [
        replace(fit.state, random_effects=fit.state.random_effects + np.diag(steps)[k])
        for k in states
    ]
    return _differences(fit, moved, steps[list(states)])


def _differences(fit: Fit, moved: Sequence[State], steps: Array) -> list[Array]:
    """Derivatives (m, n) of the innovations of each log, each by a state that has moved."""
    moved_innovations = [of_all(fit.problem, fit.hypothesis, state, fit.lags)[1] for state in moved]
    return [
        (np.array([other[i] for other in moved_innovations]).reshape(-1, r.size) - r)
        / steps[:, None]
        for i, r in enumerate(fit.innovations)
    ]
