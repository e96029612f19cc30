"""An explanation of all logs: base, effects, a tyre's own form, what each log has of its own.

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
_STEP_OF_OWN = 1.0 / 15.0  # of an own state, over the largest of its usual sizes


@dataclass(frozen=True)
class Explanation:
    """A hypothesis fitted to the logs of a problem.

    Of each log its ``predictions``, its ``innovations`` (n,), and their derivatives: ``columns``
    (m + 2 k, n) by x and the form of tyres, ``rest`` (4, n) by its own slope, zero of a_x, and
    first heats of its discs.
    ``settled`` the fall of the squares that a fit left to promise at most.
    """

    problem: Problem
    hypothesis: Hypothesis
    state: State
    predictions: list[Prediction]
    innovations: list[Array]
    columns: list[Array]
    rest: list[Array]
    log_evidence: float = -np.inf
    settled: float = np.inf

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
        """What was believed of all that logs share."""
        return prior_of(self.problem, self.hypothesis)

    @property
    def scaled_own(self) -> Array:
        """What each log has of its own, in standard deviations of the states that it may have."""
        S = self.hypothesis.sizes
        return np.asarray(self.state.own[:, S > 0.0] / S[S > 0.0])

    @cached_property
    def squares(self) -> float:
        """Sum of squares of the innovations and of all priors."""
        shared, rows = self.state.shared, sum(float(r @ r) for r in self.innovations)
        return float(rows + shared @ self.prior.precision @ shared + np.sum(self.scaled_own**2))

    @property
    def strain(self) -> float:
        """Distance of the own states' squares from what their priors expect, in its scatter [1]."""
        own = self.scaled_own
        return float(np.sum(own**2) - own.size) / math.sqrt(2.0 * max(own.size, 1))

    @property
    def bent(self) -> bool:
        """Whether pads and tyres are far from usual ones, as if they stood for what is missing."""
        shared = np.where(self.prior.of == "", self.state.shared, 0.0)
        return bool(shared @ self.prior.precision @ shared > _BENT * np.sum(self.prior.of == ""))

    def worth_of(self, name: str) -> float:
        """ln of the evidence that an effect gains, its price not counted, by a linear step."""
        i = int(np.argmax(self.prior.of == name))
        return float(0.5 * self.state.x[i] ** 2 / self.covariance[i, i])

    @property
    def alone(self) -> Self:
        """The same for a worker process that predicts, and needs no columns for it."""
        return replace(self, problem=self.problem.alone, columns=[], rest=[])

    @property
    def base(self) -> Base:
        """Its base parameters, with the form of the tyres."""
        return based(self.problem, self.hypothesis, self.state)[0]

    @property
    def effects(self) -> Effects:
        """The known effects and its own, with its term."""
        return based(self.problem, self.hypothesis, self.state)[1]

    @cached_property
    def runs(self) -> list[ObservedRun]:
        """The runs with what each has of its own."""
        return runs_of(self.problem, self.state.own)

    @property
    def lags(self) -> list[RunLag]:
        """How the wheels of each run follow, for predictions nearby."""
        return [made.lag for made in self.predictions]

    def moved(self, state: State) -> Self:
        """The same at another state, with the columns of this one."""
        predictions, r = of_all(self.problem, self.hypothesis, state)
        return replace(self, state=state, predictions=predictions, innovations=r)

    def own_columns(self, i: int) -> Array:
        """Derivatives (8, n) of a log by its own states; of a factor those of what it is on."""
        rest = dict(zip((*COURSES, *HEATS), self.rest[i], strict=True))
        factors = {name: self.columns[i][NAMES.index(on)] for name, on in FACTOR_ON.items()}
        return np.stack([(factors | rest)[name] for name in OWN])

    def products_with(self, further: Sequence[Array]) -> list[Products]:
        """Inner products of each log, with ``further`` columns (c, n) behind the shared ones."""
        return [
            Products.of(np.vstack([J, more]), self.own_columns(i), r, own)
            for i, (J, more, r, own) in enumerate(
                zip(self.columns, further, self.innovations, self.state.own, strict=True)
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

        ``sizes`` (8,) standard deviations of what each log has of its own, if not as here.
        """
        sizes = self.hypothesis.sizes if sizes is None else sizes
        products = products or self.products
        return Marginal.of(products, sizes, self.prior.precision, self.state.shared, damping)

    @cached_property
    def covariance(self) -> Array:
        """Covariance (m, m) of x, forms and own states marginalised."""
        m = self.state.x.size
        return np.asarray(np.linalg.inv(self.marginal().information)[:m, :m])


def innovations(
    problem: Problem, base: Base, effects: Effects, run: ObservedRun, lag: RunLag | None = None
) -> Array:
    """Whitened residuals (n,) of a run, channel after channel; ``lag`` as `predict` knows it."""
    made = predict(problem.vehicle, base, effects, run, lag)
    return whiten(residuals(run, made), problem.noise)


def of_all(
    problem: Problem,
    hypothesis: Hypothesis,
    state: State,
    lags: Iterable[RunLag | None] = repeat(None),
) -> tuple[list[Prediction], list[Array]]:
    """Prediction and innovations (n,) of each log."""
    base, effects = based(problem, hypothesis, state)
    runs = runs_of(problem, state.own)
    made = [
        predict(problem.vehicle, base, effects, run, lag)
        for run, lag in zip(runs, lags, strict=False)
    ]
    left = map(residuals, problem.runs, made)
    return made, [whiten(r, problem.noise) for r in left]


def runs_of(problem: Problem, own: Array) -> list[ObservedRun]:
    """The runs with what each has of its ``own`` (runs, 8)."""
    return [run.with_own(states) for run, states in zip(problem.runs, own, strict=True)]


def seen(
    problem: Problem, hypothesis: Hypothesis, state: State, known: Sequence[Array] = ()
) -> Explanation:
    """A hypothesis at a state, its columns by differences; see `with_columns`."""
    predictions, r = of_all(problem, hypothesis, state)
    return with_columns(Explanation(problem, hypothesis, state, predictions, r, [], []), known)


def with_columns(at: Explanation, known: Sequence[Array] = ()) -> Explanation:
    """The same with columns of its own place, by differences.

    Those by the first elements of x of each log may be ``known`` from a state nearby, and the last
    ones, by the form, too.
    """
    state, m, k = at.state, at.state.x.size, at.state.form.size
    first = len(known[0]) - k if known else 0
    steps = np.where(state.x + _STEP < at.prior.high[:m], _STEP, -_STEP)
    moved = [replace(state, x=state.x + step) for step in np.diag(steps)[first:]]
    J = _differences(at, moved, steps[first:])
    form = known or _by_form(at)
    parts = zip(known or form, J, form, strict=True)
    J = [np.vstack([a[:first], b, at.hypothesis.departs * c[-k:]]) for a, b, c in parts]
    if FADE in at.effects:
        heat = columns_by_own(at, (FRONT_HEAT, REAR_HEAT))
    else:
        heat = [np.zeros((2, r.size)) for r in at.innovations]
    rest = [np.vstack(both) for both in zip(at.problem.courses, heat, strict=True)]
    return replace(at, columns=J, rest=rest)


def _by_form(at: Explanation) -> list[Array]:
    """Derivatives (2 k, n) of the innovations of each log by the form of front and rear tyres."""
    found, hats = [], np.eye(FORM_AT.size)
    for run, made in zip(at.problem.runs, at.predictions, strict=True):
        shares = np.stack([[np.interp(use, FORM_AT, hat) for use in made.use] for hat in hats])
        omega = np.stack([shares * made.lost] * 2)
        omega[0, :, 2:], omega[1, :, :2] = 0.0, 0.0
        found.append(whiten(of_wheels(run, np.concatenate(omega)), at.problem.noise))
    return found


def columns_by_own(at: Explanation, which: Sequence[int]) -> list[Array]:
    """Derivatives of the innovations of each log by some states of its own."""
    steps = _STEP_OF_OWN * sizes(KINDS)
    moved = [replace(at.state, own=at.state.own + np.diag(steps)[k]) for k in which]
    return _differences(at, moved, steps[list(which)])


def _differences(at: Explanation, moved: Sequence[State], steps: Array) -> list[Array]:
    """Derivatives (m, n) of the innovations of each log, each by a state that has moved."""
    found = [of_all(at.problem, at.hypothesis, state, at.lags)[1] for state in moved]
    return [
        (np.array([other[i] for other in found]).reshape(-1, r.size) - r) / steps[:, None]
        for i, r in enumerate(at.innovations)
    ]
