"""What may explain the logs: effects by name, kinds in which logs differ, a term; and its state."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array
from calib.car.effects.catalogue import definition
from calib.car.effects.effect import Parameter
from calib.car.effects.effects import Effects, EmpiricalTerm
from calib.diagnosis.explanation.base import (
    BASE,
    FORM_LIMIT,
    FORM_PRIOR,
    HIGH,
    LOW,
    NAMES,
    OWN,
    Base,
    base_of,
    base_sigma,
    sizes,
)
from calib.diagnosis.explanation.problem import Problem

FADE = "pad_thermal_fade"

_TURNING = ("disc_thickness_variation", "tone_ring_runout")  # with the angle of the wheels
_IN_EVERY_CAR = frozenset({"aerodynamic_drag", "rolling_resistance", "rolling_radius_mismatch"})
"""Effects that no car is without: their size alone is in question."""

STRENGTH = 2.0  # standard deviation of the strength of an effect, in spreads of its card
_FURTHER = 1.0  # the same of its further parameters
PRICE = 5.0  # ln of the odds, before logs are read, against an effect or a kind they differ in
_PHASE = 2.0  # the same, for each run, for the angle at which a ripple begins: it was taken from it
_FIRST = 5.0  # standard deviation of the first value of a walk, in increments
_BEGIN = 0.25  # logarithm of the peak from which a fit begins, over the usual one


@dataclass(frozen=True)
class State:
    """``x`` of base and effects as for `based`, ``form`` (2 k,), ``random_effects`` (runs, 8)."""

    x: Array
    form: Array
    random_effects: Array

    @property
    def shared(self) -> Array:
        """What all logs share: x and the form (m + 2 k,)."""
        return np.concatenate([self.x, self.form])


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
        steps = np.diff(np.eye(len(self.knots)), axis=0, prepend=0.0)
        steps[0, 0] = 1.0 / _FIRST
        return np.asarray(steps.T @ steps / self.size**2)

    @property
    def limit(self) -> float:
        """Largest value [1]: of a brake torque, and of a force over the weight."""
        return 0.9 if self.place.endswith("brakes") else 0.1


@dataclass(frozen=True)
class Hypothesis:
    """Effects by name, and the kinds in which logs differ, see `calib.diagnosis.explanation.base`.

    And those in which they are ``alike``; with a ``walk`` over a driver, where something is left
    that no effect explains; ``has_discrepancy`` whether tyres may depart from their form.
    """

    names: tuple[str, ...] = ()
    kinds: frozenset[str] = frozenset()
    alike: frozenset[str] = frozenset()
    walk: Walk | None = None
    has_discrepancy: bool = True

    @property
    def key(self) -> object:
        """What it says, whatever its order."""
        return frozenset(self.names), self.kinds, self.walk

    @property
    def parts(self) -> frozenset[str]:
        """All that it says."""
        return frozenset(self.names) | self.kinds

    @property
    def sizes(self) -> Array:
        """Standard deviations (8,) of what each log has of its own."""
        return sizes(self.kinds, self.alike)

    def price(self, runs: int) -> float:
        """ln of the odds against it before so many logs are read."""
        parts = len(self.names) + len(self.kinds) + (self.walk is not None)
        return PRICE * parts + self.phases(runs)

    @property
    def expected(self) -> float:
        """The part of these odds that is of effects in every car: none where logs cannot tell."""
        return PRICE * len(_IN_EVERY_CAR & {*self.names})

    def phases(self, runs: int) -> float:
        """The part of these odds that is the angles at which its effects begin."""
        return _PHASE * runs * len(set(_TURNING) & set(self.names))


@dataclass(frozen=True)
class Element:
    """A ``parameter`` of an ``effect``: x in units of its spread, counted from its ``origin``.

    That is the value of the vehicle file, if it has any; else the neutral one for a strength, the
    typical one for any other parameter. ``sigma`` is the standard deviation of the prior on x.
    """

    effect: str
    parameter: Parameter
    origin: float
    sigma: float

    @property
    def low(self) -> float:
        """Least x, by the card."""
        return (self.parameter.low - self.origin) / self.parameter.spread

    @property
    def high(self) -> float:
        """Largest x, by the card."""
        return (self.parameter.high - self.origin) / self.parameter.spread

    def value(self, x: float) -> float:
        """The parameter [SI]."""
        p = self.parameter
        return min(max(self.origin + x * p.spread, p.low), p.high)


def elements_of(effects: Effects, name: str) -> list[Element]:
    """The parameters of one effect, beside those that the vehicle file has."""
    card = definition(effects, name).card
    values = effects.parameters.get(name, {card.parameters[0].name: card.neutral})
    sigmas = [STRENGTH, *[_FURTHER] * (len(card.parameters) - 1)]
    pairs = zip(card.parameters, sigmas, strict=True)
    return [Element(name, p, values.get(p.name, p.typical), sigma) for p, sigma in pairs]


def elements(problem: Problem, names: tuple[str, ...]) -> list[Element]:
    """The parameters of all these effects, which stand behind the base."""
    return [one for name in names for one in elements_of(problem.vehicle.effects, name)]


@dataclass(frozen=True)
class Prior:
    """Of all that logs share, x and the form of tyres (m + 2 k,): normal about zero.

    With this ``precision`` (m + 2 k, m + 2 k), from ``low`` to ``high``. ``effect_names``
    (m + 2 k,) of the effect that has each, "" for base, walk and form.
    """

    effect_names: NDArray[np.str_]
    low: Array
    high: Array
    precision: Array


def prior_of(problem: Problem, hypothesis: Hypothesis) -> Prior:
    """Return the prior of a hypothesis, before the logs are read."""
    from scipy.linalg import block_diag

    of_effects = elements(problem, hypothesis.names)
    walks = [] if hypothesis.walk is None else [hypothesis.walk]
    most = [*(walk.limit for walk in walks for _ in walk.knots), *len(FORM_PRIOR) * [FORM_LIMIT]]
    slowest = max(run.step / run.averaged for run in problem.runs)
    sigma = np.append(base_sigma(slowest), [one.sigma for one in of_effects])
    effects = [one.effect for one in of_effects]
    return Prior(
        np.array([*BASE * [""], *effects, *len(most) * [""]]),
        np.concatenate([LOW, [one.low for one in of_effects], np.negative(most)]),
        np.concatenate([HIGH, [one.high for one in of_effects], most]),
        block_diag(np.diag(sigma**-2.0), *(walk.precision for walk in walks), FORM_PRIOR),
    )


def based(problem: Problem, hypothesis: Hypothesis, state: State) -> tuple[Base, Effects]:
    """Base and effects of a state."""
    car_effects, parameters = problem.vehicle.effects, dict[str, dict[str, float]]()
    for one, fit in zip(elements(problem, hypothesis.names), state.x[BASE:].tolist(), strict=False):
        parameters.setdefault(one.effect, {})[one.parameter.name] = one.value(fit)
    effects = car_effects.with_(Effects(parameters))
    if (walk := hypothesis.walk) is not None:
        values_of_walk = tuple(state.x[-len(walk.knots) :].tolist())
        term = EmpiricalTerm(walk.place, walk.driver, walk.knots, values_of_walk)
        effects = replace(effects, terms=(term,))
    base = base_of(problem.vehicle, state.x[:BASE])
    return replace(base, form=state.form.reshape(base.form.shape)), effects


def start_of(problem: Problem) -> State:
    """Where a fit without effects begins: at a high peak, as forces past it tell nothing of it."""
    return State(
        _BEGIN * np.eye(BASE)[NAMES.index("peak")],
        np.zeros(len(FORM_PRIOR)),
        np.zeros((len(problem.runs), len(OWN))),
    )
