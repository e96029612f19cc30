"""An explanation of all logs: base, effects, a tyre's own form, what each log has of its own.

    state --predict--> innovations r      r + J dx + F df + N du      one linear model a round

A few rounds of Gauss and Newton find the state; J follows by Broyden's secant updates, so a round
costs one prediction of every log. The evidence is Laplace's about it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from calib.base.arrays import Array
from calib.car.braking import BITE
from calib.car.disc_temperature import START
from calib.car.effects.effects import Effects, EmpiricalTerm
from calib.diagnosis.explanation.base import FORM_AT, Base, Ground, form_covariance
from calib.diagnosis.explanation.channels import CHANNELS, of_wheels, residuals, whiten
from calib.diagnosis.explanation.gaussian import Marginal, Products
from calib.diagnosis.explanation.own import FRONT_HEAT, OWN, REAR_HEAT, SLOPE, ZERO, sizes
from calib.diagnosis.explanation.predict import ObservedRun, predict
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.explanation.vector import bounds, unpack

FADE = "pad_thermal_fade"

STRENGTH, FURTHER = 2.0, 1.0
"""Standard deviations of the priors on the strength of an effect and on its further parameters, in
spreads of its card."""

PRICE = 5.0
"""ln of the odds against an effect, or against logs that differ in a kind, before they are read."""

ALMOST, SETTLED, ROUGHLY = 0.1, 2.0, 20.0
"""Falls of the sum of squares from which a fit goes on: the last one, one that is compared, and one
that only tells what to try."""

_PRECISION = np.linalg.inv(form_covariance())
_STEP = 1e-3
_FIRST = 5.0
_ROUNDS, _REFRESHED, _DAMPING, _MOST_DAMPED = 20, 3, 1e-3, 1e4
_HIGH, PEAK_AT = 0.25, 3
"""Logarithm of the peak from which a fit begins, over the usual one; its place in x."""
_BENT = 2.0
"""Mean square of pads and tyres, in standard deviations, from which they stand for an effect."""
_HEAT = 10.0
"""Step of a start heat [K]."""


@dataclass(frozen=True)
class State:
    """``x`` of base and effects as `unpack` reads it, ``form`` (2 k,), ``own`` (runs, 8)."""

    x: Array
    form: Array
    own: Array


@dataclass(frozen=True)
class Walk:
    """An empirical term whose values at the ``knots`` of its driver are a random walk.

    ``size`` is the standard deviation of an increment, the first value has `_FIRST` times that [1].
    """

    place: str
    driver: str
    knots: tuple[float, ...]
    size: float

    @property
    def precision(self) -> Array:
        """Precision (k, k) of the values."""
        one = np.eye(len(self.knots))
        steps = np.diff(one, axis=0, prepend=0.0 * one[:1])
        steps[0, 0] = 1.0 / _FIRST
        return np.asarray(steps.T @ steps / self.size**2)

    @property
    def limit(self) -> float:
        """Largest value [1]: of a brake torque, and of a force over the weight."""
        return 0.9 if self.place.endswith("brakes") else 0.1

    def term(self, values: Array) -> EmpiricalTerm:
        """The term with its values (k,)."""
        return EmpiricalTerm(self.place, self.driver, self.knots, tuple(values.tolist()))


@dataclass(frozen=True)
class Hypothesis:
    """Effects by name, and the kinds in which logs differ, see `calib.diagnosis.explanation.own`.

    And those in which they are ``alike``; with a ``walk`` over a driver, where something is left
    that no effect explains; ``departs`` whether tyres may depart from their form.
    """

    names: tuple[str, ...] = ()
    kinds: frozenset[str] = frozenset()
    alike: frozenset[str] = frozenset()
    walk: Walk | None = None
    departs: bool = True

    @property
    def key(self) -> tuple[frozenset[str], frozenset[str]]:
        """What it says, whatever its order."""
        return frozenset(self.names), self.kinds

    @property
    def sizes(self) -> Array:
        """Standard deviations (8,) of what each log has of its own."""
        return sizes(self.kinds, self.alike)

    @property
    def price(self) -> float:
        """ln of the odds against it before the logs are read."""
        return PRICE * (len(self.names) + len(self.kinds) + (self.walk is not None))


@dataclass(frozen=True)
class Columns:
    """Derivatives of the innovations of each log.

    By ``x`` (m, n), by the ``form`` (2 k, n), by the first ``heat`` of its discs (2, n), where
    pads fade.
    """

    x: list[Array]
    form: list[Array]
    heat: list[Array]

    def kept(self, which: Array) -> "Columns":
        """Those by some elements of x alone."""
        return replace(self, x=[J[which] for J in self.x])


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
    def strain(self) -> float:
        """Distance of the own states' squares from what their priors expect, in its scatter [1]."""
        S = self.hypothesis.sizes
        own = self.state.own[:, S > 0.0] / S[S > 0.0]
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


def prior_precision(problem: Problem, hypothesis: Hypothesis) -> Array:
    """Precision (m, m) of the prior on x."""
    from scipy.linalg import block_diag

    own = [[STRENGTH] + [FURTHER] * (problem.parameters_of(n) - 1) for n in hypothesis.names]
    sigma = np.concatenate([problem.base_sigma, *own])
    walk = [] if hypothesis.walk is None else [hypothesis.walk.precision]
    return np.asarray(block_diag(np.diag(sigma**-2.0), *walk))


def bounds_of(problem: Problem, hypothesis: Hypothesis) -> tuple[Array, Array]:
    """Least and largest x (m,)."""
    low, high = bounds(problem, hypothesis.names)
    if hypothesis.walk is None:
        return low, high
    most = np.full(len(hypothesis.walk.knots), hypothesis.walk.limit)
    return np.concatenate([low, -most]), np.concatenate([high, most])


def based(problem: Problem, hypothesis: Hypothesis, state: State) -> tuple[Base, Effects]:
    """Base and effects of a state."""
    base, effects = unpack(problem, hypothesis.names, state.x)
    if (walk := hypothesis.walk) is not None:
        effects = replace(effects, terms=(walk.term(state.x[-len(walk.knots) :]),))
    form = state.form.reshape(2, FORM_AT.size)
    return (replace(base, form=form) if np.any(form) else base), effects


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
    white = whiten(residuals(run, predict(problem.vehicle, base, effects, run)), problem.noise)
    return np.concatenate(white)


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


def columns_by_heat(
    problem: Problem, hypothesis: Hypothesis, state: State, r: list[Array]
) -> list[Array]:
    """Derivatives (2, n) of the innovations of each log by the first heat of its discs."""
    out = [np.zeros((2, one.size)) for one in r]
    base, effects = based(problem, hypothesis, state)
    if FADE not in effects:
        return out
    for i, run in enumerate(problem.runs):
        if run.warm or np.max(run.p_mc) < BITE:
            continue
        for k, place in enumerate((FRONT_HEAT, REAR_HEAT)):
            own = state.own[i].copy()
            own[place] += _HEAT
            moved = innovations(problem, base, effects, driven(run, own))
            out[i][k] = (moved - r[i]) / _HEAT
    return out


def columns_by_x(
    problem: Problem, hypothesis: Hypothesis, state: State, r: list[Array], first: int
) -> list[Array]:
    """Derivatives of the innovations of each log by x from its element ``first`` on."""
    high = bounds_of(problem, hypothesis)[1]
    found, runs = [], runs_of(problem, state.own)
    for k in range(first, state.x.size):
        step = _STEP if state.x[k] + _STEP < high[k] else -_STEP
        x = state.x.copy()
        x[k] += step
        moved = of_all(problem, hypothesis, replace(state, x=x), runs)
        found.append([(a - b) / step for a, b in zip(moved, r, strict=True)])
    if not found:
        return [np.zeros((0, one.size)) for one in r]
    return [np.stack(of_run) for of_run in zip(*found, strict=True)]


def columns_by_form(problem: Problem, hypothesis: Hypothesis, state: State) -> list[Array]:
    """Derivatives (2 k, n) of the innovations of each log by the form of front and rear tyres."""
    base, effects = based(problem, hypothesis, state)
    found = []
    for run, own in zip(problem.runs, state.own, strict=True):
        at = predict(problem.vehicle, base, effects, driven(run, own))
        columns = []
        for wheels in ([0, 1], [2, 3]):
            for hat in np.eye(FORM_AT.size):
                omega = np.zeros_like(at.omega)
                omega[wheels] = at.lost[wheels] * np.interp(at.use[wheels], FORM_AT, hat)
                columns.append(np.concatenate(whiten(of_wheels(run, omega), problem.noise)))
        found.append(float(hypothesis.departs) * np.stack(columns))
    return found


def fit(
    problem: Problem,
    hypothesis: Hypothesis,
    state: State,
    near: Columns | None = None,
    settled: float = SETTLED,
) -> Explanation:
    """Fit a hypothesis from a state. ``near`` are columns nearby, by the first elements of x.

    It has ``settled`` where the sum of squares promises to fall by no more. The evidence is that of
    the linear model, thus hardly less right where more is promised.
    """
    low, high = bounds_of(problem, hypothesis)
    state = replace(state, x=np.clip(state.x, low + 1e-6, high - 1e-6))
    r = of_all(problem, hypothesis, state)
    known = near.x[0].shape[0] if near else 0
    more = columns_by_x(problem, hypothesis, state, r, known)
    J = [np.vstack([a, b]) for a, b in zip(near.x, more, strict=True)] if near else more
    form = near.form if near else columns_by_form(problem, hypothesis, state)
    heat = columns_by_heat(problem, hypothesis, state, r)
    at = Explanation(problem, hypothesis, state, r, Columns(J, form, heat))
    at = _settled(at, settled, fresh=near is None)
    if settled > SETTLED:
        if near is not None and (hypothesis.names or hypothesis.walk):
            at = _settled(_refreshed(at, problem.base_size), settled)
    else:
        at = _proved(at, settled)
    return replace(at, log_evidence=at.marginal().evidence(settled) - hypothesis.price)


def _refreshed(at: Explanation, first: int = 0) -> Explanation:
    """With fresh columns by x from its element ``first`` on, and by the form."""
    more = columns_by_x(at.problem, at.hypothesis, at.state, at.innovations, first)
    J = [np.vstack([a[:first], b]) for a, b in zip(at.columns.x, more, strict=True)]
    form = columns_by_form(at.problem, at.hypothesis, at.state)
    heat = columns_by_heat(at.problem, at.hypothesis, at.state, at.innovations)
    return replace(at, columns=Columns(J, form, heat))


def _proved(at: Explanation, least: float) -> Explanation:
    """Settled with columns of its own place: secant ones may promise too little."""
    for _ in range(_REFRESHED):
        before = at.state
        at = _settled(_refreshed(at), least, fresh=True)
        if at.state is before:
            break
    return at


def _settled(at: Explanation, least: float, *, fresh: bool = False) -> Explanation:
    """Damped steps of Gauss and Newton until they promise nothing more (Levenberg 1944).

    Secant updates between them; columns are computed anew where a step brings less than a quarter
    of its promise.
    """
    problem, hypothesis = at.problem, at.hypothesis
    low, high = bounds_of(problem, hypothesis)
    S, left, damping = hypothesis.sizes, _REFRESHED, 0.0
    square = objective(at, S)
    for _ in range(_ROUNDS):
        model = _Local(at, low, high)
        if model.step(0.0).promised < least:
            return at
        while damping < _MOST_DAMPED:
            step = model.step(damping)
            other = model.moved(step)
            value = objective(other, S)
            if value < square:
                break
            damping = max(10.0 * damping, _DAMPING)
        else:
            other, value, damping = at, square, _DAMPING
        fall = square - value
        poor = fall < 0.25 * step.promised
        if value < square:
            at, square, fresh, damping = other, value, False, 0.1 * damping
            if fall < 0.5 * least:
                return at
        if poor:
            if fresh or left == 0:
                return at
            at, fresh, left = _refreshed(at), True, left - 1
    return at


class _Local:
    """The linear model of all logs at a state, and steps of it inside the bounds of x.

    No step is longer than a linear model holds.
    """

    def __init__(self, at: Explanation, low: Array, high: Array) -> None:
        self.at, self.low, self.high = at, low, high
        self.sizes, self.m = at.hypothesis.sizes, at.state.x.size
        most = np.full(self.m + at.state.form.size, 0.3)
        most[at.problem.base_size : bounds(at.problem, at.names)[0].size] = 1.5
        self.least, self.most = -most, most.copy()
        self.least[: self.m] = np.maximum(low - at.state.x, -most[: self.m])
        self.most[: self.m] = np.minimum(high - at.state.x, most[: self.m])

    def step(self, damping: float) -> "_Step":
        """Damped; what would leave its bounds ends there."""
        at = self.at
        whole = marginal(at, at.products, self.sizes, damping)
        H, g = whole.information, whole.gradient
        H = H + damping * np.diag(np.diag(H))
        free, step = np.ones(g.size, bool), np.zeros(g.size)
        for _ in range(g.size):
            step[free] = -np.linalg.solve(H[np.ix_(free, free)], (g + H @ (step * ~free))[free])
            past = free & ((step < self.least) | (step > self.most))
            if not past.any():
                break
            step = np.clip(step, self.least, self.most)
            free &= ~past
        own = [one.reduced(self.sizes, damping)[1] @ np.append(step, 1.0) for one in at.products]
        fall = -(2.0 * g @ step + step @ H @ step) + objective(at, self.sizes) - whole.squares
        return _Step(step, -np.stack(own), float(fall))

    def moved(self, step: "_Step") -> Explanation:
        """The explanation after a step, with secant columns."""
        at, m = self.at, self.m
        state = State(
            np.clip(at.state.x + step.shared[:m], self.low, self.high),
            at.state.form + step.shared[m:],
            at.state.own + step.own,
        )
        other = replace(at, state=state, innovations=of_all(at.problem, at.hypothesis, state))
        return replace(other, columns=_secant(at, other))


@dataclass(frozen=True)
class _Step:
    """Steps of x and form, of own states (runs, 8), and the fall of the squares they promise."""

    shared: Array
    own: Array
    promised: float


def objective(at: Explanation, S: Array) -> float:
    """Sum of squares of the innovations and of all priors."""
    precision = prior_precision(at.problem, at.hypothesis)
    own = at.state.own[:, S > 0.0] / S[S > 0.0]
    x, f = at.state.x, at.state.form
    rows = sum(float(r @ r) for r in at.innovations)
    return float(rows + x @ precision @ x + f @ _PRECISION @ f + np.sum(own**2))


def _secant(at: Explanation, other: Explanation) -> Columns:
    """Columns by x at ``other``, by Broyden's good update."""
    dx = other.state.x - at.state.x
    df = other.state.form - at.state.form
    length = float(dx @ dx)
    if length == 0.0:
        return at.columns
    J = []
    for i, (a, b) in enumerate(zip(at.innovations, other.innovations, strict=True)):
        du = other.state.own[i] - at.state.own[i]
        told = dx @ at.columns.x[i] + df @ at.columns.form[i] + du @ own_columns(at, i)
        J.append(at.columns.x[i] + np.outer(dx, b - a - told) / length)
    return replace(at.columns, x=J)


def start_of(problem: Problem) -> State:
    """Where a fit without effects begins: at a high peak, as forces past it tell nothing of it."""
    return State(
        _HIGH * np.eye(problem.base_size)[PEAK_AT],
        np.zeros(2 * FORM_AT.size),
        np.zeros((len(problem.runs), len(OWN))),
    )
