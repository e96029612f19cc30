"""What may explain the logs: effects by name, groups in which logs differ, an empirical term.

A `Hypothesis` says which of these act, a `State` how large they are. The vector x of a state has
the base parameters, then an `Element` for each parameter of an effect, then the values of an
empirical term, a `Walk`. `prior_of` gives the prior, `base_and_effects` the physics of a state.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array
from calib.car.effects.catalogue import definition
from calib.car.effects.effect import Parameter
from calib.car.effects.effects import Effects, EmpiricalTerm
from calib.diagnosis.explanation import unknowns
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.explanation.unknowns import BASE_SIZE, DISCREPANCY_PRECISION, Base

FADE = "pad_thermal_fade"
_RIPPLES = ("disc_thickness_variation", "tone_ring_runout")  # effects that go with the wheel angle
_IN_EVERY_CAR = frozenset({"aerodynamic_drag", "rolling_resistance", "rolling_radius_mismatch"})
STRENGTH = 2.0
"""Standard deviation of the first parameter of an effect, its strength, in spreads of its card."""
_FURTHER = 1.0  # the same for further parameters
PRICE = 5.0  # ln of the prior odds against an effect, or a group in which logs differ
_PHASE = 2.0  # price of the angle of a ripple in a run, since the angle was fitted to that run
_FIRST = 5.0  # standard deviation of the first value of a walk, in increments
_START_OF_PEAK = 0.25
"""x of the tyre's peak where a fit begins, above the usual one: forces beyond a peak have no
derivative by it, so a fit that begins with too low a peak may stay there."""


@dataclass(frozen=True)
class State:
    """Values of all unknowns of a hypothesis."""

    x: Array  # of base, effects and term (m,)
    discrepancy: Array  # (2 k,)
    random_effects: Array  # (runs, 8)

    @property
    def shared(self) -> Array:
        """What all logs share: x and the discrepancy (m + 2 k,)."""
        return np.concatenate([self.x, self.discrepancy])


@dataclass(frozen=True)
class Walk:
    """An empirical term whose values at the knots of its driver are a random walk."""

    place: str
    driver: str
    knots: tuple[float, ...]
    size: float  # standard deviation of an increment [1]

    @property
    def precision(self) -> Array:
        """Precision (k, k) of the values."""
        increments = np.diff(np.eye(len(self.knots)), axis=0, prepend=0.0)  # by the values (k, k)
        increments[0, 0] = 1.0 / _FIRST
        return np.asarray(increments.T @ increments / self.size**2)

    @property
    def limit(self) -> float:
        """Largest value [1]: a share of a brake torque, or of the weight for a force."""
        return 0.9 if self.place.endswith("brakes") else 0.1


@dataclass(frozen=True)
class Hypothesis:
    """Effects and groups that act, and a term for what no effect explains."""

    names: tuple[str, ...] = ()  # of effects
    groups: frozenset[str] = frozenset()  # of random effects in which logs differ
    alike: frozenset[str] = frozenset()  # groups in which logs are alike
    walk: Walk | None = None  # the empirical term
    has_discrepancy: bool = True  # whether the slip of tyres may depart from its formula

    @property
    def key(self) -> "Hypothesis":
        """The hypothesis with its names in order, so that equal hypotheses have equal keys."""
        return replace(self, names=tuple(sorted(self.names)))

    @property
    def parts(self) -> frozenset[str]:
        """Names and groups."""
        return frozenset(self.names) | self.groups

    @property
    def sigmas(self) -> Array:
        """Standard deviations (8,) of the random effects of a log."""
        return unknowns.random_sigmas(self.groups, self.alike)

    def price(self, runs: int) -> float:
        """ln of the prior odds against the hypothesis, for a number of ``runs``."""
        parts = len(self.names) + len(self.groups) + (self.walk is not None)
        return PRICE * parts + self.price_of_angles(runs)

    @property
    def price_of_usual(self) -> float:
        """The part of the price for effects that are in every car."""
        return PRICE * len(_IN_EVERY_CAR & {*self.names})

    def price_of_angles(self, runs: int) -> float:
        """The part of the price for the angles at which ripples begin, one for each run."""
        return _PHASE * runs * len(set(_RIPPLES) & set(self.names))


@dataclass(frozen=True)
class Element:
    """The element x of a parameter of an effect: value = origin + x spread of its card.

    The origin is the value of the vehicle file if there is one; else the neutral value for a
    strength, the typical value for a further parameter.
    """

    effect: str
    parameter: Parameter
    origin: float
    sigma: float  # standard deviation of the prior on x, whose mean is 0

    @property
    def low(self) -> float:
        """Least x, by the card."""
        return (self.parameter.low - self.origin) / self.parameter.spread

    @property
    def high(self) -> float:
        """Largest x, by the card."""
        return (self.parameter.high - self.origin) / self.parameter.spread

    def value(self, x: float) -> float:
        """The parameter at ``x`` [SI]."""
        p = self.parameter
        return min(max(self.origin + x * p.spread, p.low), p.high)


def elements_of(effects: Effects, *names: str) -> list[Element]:
    """Return the elements of effects; ``effects`` are those of the vehicle file."""
    elements = []
    for name in names:
        card = definition(effects, name).card
        strength = card.parameters[0]
        origins = effects.parameters.get(name, {strength.name: card.neutral})
        for p in card.parameters:
            origin = origins.get(p.name, p.typical)
            sigma = STRENGTH if p is strength else _FURTHER
            elements.append(Element(name, p, origin, sigma))
    return elements


@dataclass(frozen=True)
class Prior:
    """Prior of `State.shared` (m + 2 k,): normal about zero, cut at bounds."""

    effect_names: NDArray[np.str_]  # effect of each element, "" for base, term and discrepancy
    low: Array
    high: Array
    precision: Array  # (m + 2 k, m + 2 k)


def prior_of(problem: Problem, hypothesis: Hypothesis) -> Prior:
    """Return the prior of a hypothesis, before the logs are read."""
    from scipy.linalg import block_diag

    elements = elements_of(problem.vehicle.effects, *hypothesis.names)
    # bounds and precisions of the values behind base and effects
    limits = len(DISCREPANCY_PRECISION) * [unknowns.DISCREPANCY_LIMIT]
    precisions = [DISCREPANCY_PRECISION]
    walk = hypothesis.walk
    if walk is not None:
        limits = [*len(walk.knots) * [walk.limit], *limits]
        precisions = [walk.precision, *precisions]
    sample_time = max(run.step / run.averaged for run in problem.runs)  # of the slowest log
    sigma = np.append(unknowns.base_sigma(sample_time), [element.sigma for element in elements])
    names = [element.effect for element in elements]
    return Prior(
        np.array([*BASE_SIZE * [""], *names, *len(limits) * [""]]),
        np.concatenate([unknowns.LOW, [element.low for element in elements], np.negative(limits)]),
        np.concatenate([unknowns.HIGH, [element.high for element in elements], limits]),
        block_diag(np.diag(sigma**-2.0), *precisions),
    )


def base_and_effects(
    problem: Problem, hypothesis: Hypothesis, state: State
) -> tuple[Base, Effects]:
    """Return base and effects of a state; effects include those of the vehicle file."""
    parameters: dict[str, dict[str, float]] = {}
    elements = elements_of(problem.vehicle.effects, *hypothesis.names)
    # x may go on with the values of a term
    for element, x in zip(elements, state.x[BASE_SIZE:].tolist(), strict=False):
        parameters.setdefault(element.effect, {})[element.parameter.name] = element.value(x)
    effects = problem.vehicle.effects.with_(Effects(parameters))
    walk = hypothesis.walk
    if walk is not None:
        values = tuple(state.x[-len(walk.knots) :].tolist())
        term = EmpiricalTerm(walk.place, walk.driver, walk.knots, values)
        effects = replace(effects, terms=(term,))
    base = unknowns.base_of(problem.vehicle, state.x[:BASE_SIZE])
    return replace(base, discrepancy=state.discrepancy.reshape(base.discrepancy.shape)), effects


def start_of(problem: Problem) -> State:
    """State from which a fit without effects begins."""
    return State(
        _START_OF_PEAK * np.eye(BASE_SIZE)[unknowns.BASE_NAMES.index("peak")],
        np.zeros(len(DISCREPANCY_PRECISION)),
        np.zeros((len(problem.runs), len(unknowns.RANDOM_EFFECTS))),
    )
