"""A candidate explanation: the base parameters and some effects, fitted to all runs together.

Base parameters are fitted again with every candidate: pads, mass and drag can replace each other in
part. The fit is least squares in the whitened channels of `calib.diagnosis.explanation.channels`,
with bounds from the cards. Weak priors hold parameters that a run may not determine: the peak of a
tyre that was never near it, the second parameter of an effect.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.explanation.base import Base, Ground
from calib.diagnosis.explanation.channels import (
    CHANNELS,
    ChannelNoise,
    noise_of,
    residuals,
    thinned,
    unbraked_length,
    whiten,
)
from calib.diagnosis.explanation.offsets import Course, course_of
from calib.diagnosis.explanation.own_pads import SIGMA, OwnPads
from calib.diagnosis.explanation.predict import ObservedRun, predict
from calib.diagnosis.explanation.progress import Tell, silent
from calib.diagnosis.explanation.secant import columns, least_squares
from calib.diagnosis.gates import GATES
from calib.physics.effects import aerodynamic_drag
from calib.physics.effects.effect import Card, Parameter
from calib.physics.effects.effects import Effects, EmpiricalTerm
from calib.physics.own_effects.own_effect import definition
from calib.physics.vehicle import Vehicle
from calib.processes import Mapped

Array = NDArray[np.float64]

STIFFNESS, PEAK = 25.0, 0.95
"""Start of the fit for the tyre: slip stiffness and peak of a passenger car, both per load [1]."""

SHAPE, LOAD_EXPONENT, BEND, RELAXATION, PEAK_EXPONENT = 1.65, 0.03, 0.1, 0.2, 0.04
"""Middle of the priors on the tyre's form [1, m]: passenger cars on asphalt; `calib.fitting`. The
bend of a brush is 0.55; relaxation lengths are 0.1 to 0.6 m; the peak falls by 0 to 10 % where the
load doubles. A fit begins here, within its bounds: from a bound it may not move."""

BASE_SIGMA = np.array([0.5, 0.5, 0.5, 0.35, 0.1, 0.04, 0.2, 0.2, 0.04])
"""Standard deviations of the priors on the logarithms of pads, stiffness and peak: wide; on that of
the shape factor, on the load exponent, the bend, the relaxation length and the exponent of the
peak: the spread of passenger tyres."""


BASE = BASE_SIGMA.size
"""Number of base parameters, the first ones of every vector, where the rolling radii are given."""

PEAK_PLACE = 3
"""Place of the logarithm of the tyre's peak among them, as in `base_of`."""

RADIUS_SIGMA, RADIUS_RANGE = 0.01, 0.05
"""Prior on the logarithm of the rolling radii over those of the file, and its largest value, where
they are free: tyres wear by 2 % of their radius, and heat, load and pressure change it by 0.5 %."""

DRAG, SHARE = "aerodynamic_drag", "load_share"

_SHARE = {p.name: p for p in aerodynamic_drag.EFFECT.card.parameters}[SHARE]
USUAL_SHARE, SHARE_SIGMA = _SHARE.typical, 2.0 * _SHARE.spread
SHARE_RANGE = _SHARE.high - _SHARE.typical
"""Share of a drag that moves load [1]: the middle of its prior, its spread and its range, for a
drag that is known and one that is found alike."""


@dataclass(frozen=True)
class Problem:
    """All runs of a case and their noise; ``tell`` is told of the progress, ``mapped`` carries out
    independent pieces of work.

    The effects of ``vehicle`` are known: they act in every candidate. ``free_radius`` says whether
    the rolling radii are one of the base parameters, beside those of the file. Another one is how
    much load a known drag moves, where the file does not say. ``offset`` names an effect of which
    each log has a size of its own (`calib.diagnosis.explanation.offsets`), empty if there is none.
    ``own_pads`` is the explanation at which each log may have pads and tyres of its own
    (`calib.diagnosis.explanation.own_pads`), None where all logs have those of their ground.
    """

    vehicle: Vehicle
    runs: tuple[ObservedRun, ...]
    noise: ChannelNoise
    tell: Tell = silent
    free_radius: bool = False
    mapped: Mapped = map
    offset: str = ""
    own_pads: tuple[Base, Effects] | None = None

    @property
    def alone(self) -> Self:
        """The same for a worker process, which tells nobody and has no workers of its own."""
        return replace(self, tell=silent, mapped=map)

    @property
    def base_size(self) -> int:
        """Number of base parameters, the first ones of every vector."""
        return BASE + self.free_radius + self.free_share

    @property
    def start(self) -> Array:
        """Where a fit of the base parameters alone begins, (`base_size`,)."""
        return np.zeros(self.base_size)

    @property
    def base_sigma(self) -> Array:
        """Standard deviations (`base_size`,) of their priors."""
        radius, share = [RADIUS_SIGMA] * self.free_radius, [SHARE_SIGMA] * self.free_share
        return np.array([*BASE_SIGMA, *radius, *share])

    @cached_property
    def free_share(self) -> bool:
        """Whether a drag is known, but not how much load it moves."""
        known = self.vehicle.effects.parameters.get(DRAG)
        return known is not None and SHARE not in known

    def parameters_of(self, name: str) -> int:
        """Number of parameters of an effect."""
        return len(definition(self.vehicle.effects, name).card.parameters)

    def places(self, names: tuple[str, ...]) -> dict[str, slice]:
        """Where the parameters of each effect stand in a vector, behind those of the base."""
        found, i = {}, self.base_size
        for name in names:
            found[name] = slice(i, i + self.parameters_of(name))
            i = found[name].stop
        return found

    def whitened(self, base: Base, effects: Effects) -> list[list[Array]]:
        """Innovations by run and channel."""
        found = self._with_common_pads(base, effects)
        if self.own_pads is None:
            return found
        return [pads.whitened(x) for pads, x in zip(self._pads, found, strict=True)]

    def grounds(self, base: Base, effects: Effects) -> list[Ground]:
        """The ground of each run, with its own pads and tyres where it may have such."""
        common = [run.ground for run in self.runs]
        if self.own_pads is None:
            return common
        found = self._with_common_pads(base, effects)
        return [own.ground(x, at) for own, x, at in zip(self._pads, found, common, strict=True)]

    def offsets(self, base: Base, effects: Effects) -> list[float]:
        """The offset that each run has of its own; none where the logs have no such offsets."""
        if not self.offset:
            return []
        pairs = zip(self.courses, self._residuals(base, effects), strict=True)
        return [course.offset(x) for course, x in pairs]

    @cached_property
    def courses(self) -> tuple[Course, ...]:
        """What the offset of each run moves."""
        return tuple(course_of(self.offset, run, self.noise) for run in self.runs)

    @cached_property
    def _pads(self) -> tuple[OwnPads, ...]:
        """What the own pads and tyres of each run can do."""
        explanation = self.own_pads
        assert explanation is not None
        at = self._with_common_pads(*explanation)

        def innovations(own: Array) -> Array:
            factors = np.append(own, np.zeros(len(fields(Ground)) - own.size))
            grounds = (Ground.of(run.ground.logarithms + factors) for run in self.runs)
            runs = (replace(run, ground=g) for run, g in zip(self.runs, grounds, strict=True))
            return joined(replace(self, runs=tuple(runs), own_pads=None).whitened(*explanation))

        J = columns(innovations, np.zeros(SIGMA.size), joined(at), np.full(SIGMA.size, np.inf))
        ends = np.cumsum([sum(c.size for c in run) for run in at])[:-1]
        return tuple(OwnPads.of(of_run) for of_run in np.split(J, ends))

    def _with_common_pads(self, base: Base, effects: Effects) -> list[list[Array]]:
        found = [whiten(x, self.noise) for x in self._residuals(base, effects)]
        if not self.offset:
            return found
        return [c.removed(x) for c, x in zip(self.courses, found, strict=True)]

    def _residuals(self, base: Base, effects: Effects) -> list[Array]:
        return [residuals(run, predict(self.vehicle, base, effects, run)) for run in self.runs]

    def flat(self, base: Base, effects: Effects) -> Array:
        """All innovations as one array (n,)."""
        return joined(self.whitened(base, effects))

    def chi2(self, base: Base, effects: Effects) -> float:
        """Sum of squared innovations."""
        innovations = self.flat(base, effects)
        return float(innovations @ innovations)


def joined(whitened: list[list[Array]]) -> Array:
    """Innovations by run and channel as one array (n,)."""
    return np.concatenate([c for run in whitened for c in run])


@dataclass(frozen=True, eq=False)
class Candidate:
    """A fitted explanation. Two are the same if they are one object.

    ``problem`` it was fitted to; ``names`` of its effects; ``x`` the fitted vector (see `unpack`);
    ``chi2`` the sum of squared innovations, over ``count`` of them; ``scatter`` the standard
    deviation of `reduced` where nothing is left: that of so many squares, and of the noise that
    they are held against; ``promised`` the chi-square to which more steps may come, `chi2` of a fit
    that converged. ``further`` and ``fewer`` keep the explanations with one effect more and one
    less that were fitted, by its name.
    """

    problem: Problem
    names: tuple[str, ...]
    base: Base
    effects: Effects
    x: Array
    chi2: float
    promised: float
    count: int
    scatter: float
    further: dict[str, "Candidate"] = field(init=False, repr=False, default_factory=dict)
    fewer: dict[str, "Candidate"] = field(init=False, repr=False, default_factory=dict)

    @property
    def parameters(self) -> int:
        """Number of fitted parameters; of an effect that the vehicle file has, its strength alone.

        What else that one has is given or, as the load that a drag moves, among the base
        parameters.
        """
        known = self.problem.vehicle.effects
        own = (1 if name in known else self.problem.parameters_of(name) for name in self.names)
        return self.problem.base_size + sum(own)

    @property
    def converged(self) -> bool:
        """Whether more steps would explain no more."""
        return self.promised == self.chi2

    @property
    def reduced(self) -> float:
        """Mean squared innovation [1]; 1 if the model explains everything but noise."""
        return self.chi2 / self.count

    def without(self, name: str) -> Effects:
        """The effects without what an effect of this explanation adds to the known ones."""
        return self.effects.without(name).with_(self.problem.vehicle.effects.only(name))

    @cached_property
    def whitened(self) -> list[list[Array]]:
        """Innovations at ``x`` by run and channel; without a term."""
        return self.problem.whitened(*unpack(self.problem, self.names, self.x))

    @cached_property
    def jacobian(self) -> Array:
        """Derivatives (n, k) of the innovations by ``x``; without a term and its knots."""
        problem = self.problem
        own = bounds(problem, self.names)[1]

        def innovations(x: Array) -> Array:
            return problem.flat(*unpack(problem, self.names, x))

        return columns(innovations, self.x[: own.size], joined(self.whitened), own)

    @cached_property
    def directions(self) -> Array:
        """Orthonormal directions (n, k) in which base and effects move the innovations."""
        return np.asarray(np.linalg.qr(self.jacobian)[0])

    @cached_property
    def rest(self) -> Array:
        """The innovations (n,) without what base and effects can do about them."""
        return free(joined(self.whitened), self.directions)

    @cached_property
    def covariance(self) -> Array:
        """Covariance (k, k) of ``x``."""
        return covariance_of(self.problem, self.names, self.jacobian)


def covariance_of(problem: Problem, names: tuple[str, ...], J: Array) -> Array:
    """Covariance (k, k) of a vector, from derivatives J (n, k) of the innovations, and priors."""
    priors = prior_derivatives(problem, names, J.shape[1])
    return np.asarray(np.linalg.pinv(J.T @ J + priors.T @ priors))


def free(x: Array, directions: Array) -> Array:
    """The part of ``x`` (n,) that does not lie along orthonormal ``directions`` (n, k)."""
    return np.asarray(x - directions @ (directions.T @ x))


def derivatives(problem: Problem, at: Candidate, innovations: Array) -> Array:
    """Derivatives (n, k) of the ``innovations`` (n,) of a candidate by its vector."""
    return columns(
        lambda x: problem.flat(*unpack(problem, at.names, x)),
        at.x,
        innovations,
        np.full(at.x.size, np.inf),
    )


def problem_of(
    vehicle: Vehicle, runs: list[ObservedRun], tell: Tell = silent, mapped: Mapped = map
) -> Problem:
    """Build a problem; its noise is that of the unbraked parts, where no base parameter acts."""
    nominal = base_of(vehicle, np.zeros(BASE))
    noise = _unbraked_noise(vehicle, nominal, vehicle.effects, runs)
    turned = tuple(turned_to_ripple(vehicle, nominal, run, noise) for run in runs)
    return Problem(vehicle, turned, noise, tell, mapped=mapped)


def _unbraked_noise(
    vehicle: Vehicle, base: Base, effects: Effects, runs: Sequence[ObservedRun]
) -> ChannelNoise:
    wholes = [residuals(run, predict(vehicle, base, effects, run)) for run in runs]
    pairs = zip(runs, wholes, strict=True)
    return noise_of([whole[:, : unbraked_length(run)] for run, whole in pairs], wholes)


def without_its_noise(best: Candidate) -> Problem | None:
    """The problem with the noise that is left with an explanation, None if that is no quieter.

    An effect that acts in unbraked parts, such as a tone ring that runs out, was part of the noise.
    """
    problem = best.problem
    noise = _unbraked_noise(problem.vehicle, best.base, best.effects, problem.runs)
    if np.all(noise.sigma > GATES.quieter * problem.noise.sigma):
        return None
    return replace(problem, noise=noise)


def turned_to_ripple(
    vehicle: Vehicle, base: Base, run: ObservedRun, noise: ChannelNoise
) -> ObservedRun:
    """Set the origin of a run's wheel angle by the phase of its torque ripple, if it has one.

    Every run begins at another angle of the disc. Where the front torque is high, the car and its
    front wheels slow: a_x and front less rear go with -sin(angle). A sensor that ripples does so
    without torque too, in front less rear alone: there `coasting` counts besides. The ripple that
    is looked for is whitened as the residuals are, for a filter delays fast turns and slow ones
    differently.
    """
    white = whiten(residuals(run, predict(vehicle, base, vehicle.effects, run)), noise)
    torque = np.maximum(thinned(run, run.p_mc), 0.0)
    weights = np.stack([torque, *4 * [torque + GATES.coasting], torque])
    turn = weights * np.exp(1j * thinned(run, run.angle_f))
    plain = replace(noise, sigma=np.ones_like(noise.sigma))
    parts = zip(whiten(turn.real, plain), whiten(turn.imag, plain), strict=True)
    looked_for = [cosine + 1j * sine for cosine, sine in parts]
    ripple = sum(complex(np.sum(white[c] * looked_for[c])) for c in (0, 3))
    return replace(run, angle_f=run.angle_f - float(np.angle(ripple)) - 0.5 * np.pi)


def base_of(vehicle: Vehicle, x: Array) -> Base:
    """Base parameters from the first ones of the vector; logarithms of the ratio to nominal.

    ``x`` has `BASE` of them, and one more where the rolling radii are free.
    """
    return Base(
        pad_friction_f=vehicle.front.pad_friction * float(np.exp(x[0])),
        pad_friction_r=vehicle.rear.pad_friction * float(np.exp(x[1])),
        stiffness=STIFFNESS * float(np.exp(x[2])),
        peak=PEAK * float(np.exp(x[PEAK_PLACE])),
        shape=SHAPE * float(np.exp(x[4])),
        load_exponent=LOAD_EXPONENT + float(x[5]),
        bend=max(BEND + float(x[6]), 0.0),
        relaxation=max(RELAXATION + float(x[7]), 0.0),
        peak_exponent=PEAK_EXPONENT + float(x[8]),
        radius=float(np.exp(x[BASE])) if x.size > BASE else 1.0,
    )


def unpack(problem: Problem, names: tuple[str, ...], x: Array) -> tuple[Base, Effects]:
    """Base and effects from a vector: the base, then the parameters of the effects.

    A parameter is in units of its spread and counts from its origin, see `origins`. The load that a
    known drag moves is that of the drag's own parameters where these are found anew.
    """
    known, given = _with_share(problem, x), problem.vehicle.effects
    found, i = {}, problem.base_size
    for name in names:
        card = definition(known, name).card
        values = {}
        for p, origin in zip(card.parameters, origins(given, card), strict=True):
            values[p.name] = origin + float(x[i]) * p.spread
            i += 1
        found[name] = values
    base = base_of(problem.vehicle, x[: BASE + problem.free_radius])
    return base, known.with_(Effects(found))


def vector_of(problem: Problem, base: Array, effects: Effects) -> Array:
    """The vector that `unpack` turns into ``effects``, behind that of the ``base``."""
    given, own = problem.vehicle.effects, []
    for name in effects.names:
        card = definition(given, name).card
        values = effects.parameters[name]
        for p, origin in zip(card.parameters, origins(given, card), strict=True):
            own.append((values.get(p.name, p.typical) - origin) / p.spread)
    return np.concatenate([base, own])


def _with_share(problem: Problem, x: Array) -> Effects:
    """The known effects, with the load that a known drag moves by the vector."""
    known = problem.vehicle.effects
    if not problem.free_share:
        return known
    share = USUAL_SHARE + float(x[BASE + problem.free_radius])
    return replace(
        known, parameters={**known.parameters, DRAG: {**known.parameters[DRAG], SHARE: share}}
    )


def origins(known: Effects, card: Card) -> tuple[float, ...]:
    """Where the parameters of an effect count from: the values of the vehicle file, if it has any.

    Else the neutral value for a strength, the typical value for any other parameter.
    """
    if card.name in known:
        given = known.parameters[card.name]
        return tuple(given.get(p.name, p.typical) for p in card.parameters)
    return (card.neutral, *(p.typical for p in card.parameters[1:]))


def bounds(problem: Problem, names: tuple[str, ...]) -> tuple[Array, Array]:
    """Bounds of the vector: the cards' ranges."""
    low = [-GATES.pads, -GATES.pads, -2.0, -2.0, -0.4, -0.2, -BEND, -RELAXATION, -0.2]
    high = [GATES.pads, GATES.pads, 2.0, 2.0, 0.18, 0.2, 0.7, 1.0, 0.2]
    if problem.free_radius:
        low, high = [*low, -RADIUS_RANGE], [*high, RADIUS_RANGE]
    if problem.free_share:
        low, high = [*low, -SHARE_RANGE], [*high, SHARE_RANGE]
    known = problem.vehicle.effects
    for name in names:
        card = definition(known, name).card
        for p, origin in zip(card.parameters, origins(known, card), strict=True):
            low.append((p.low - origin) / p.spread)
            high.append((p.high - origin) / p.spread)
    return np.array(low) - 1e-9, np.array(high) + 1e-9


def shown(at: Candidate) -> dict[str, float]:
    """What the chi-square would rise by without each effect, all else fitted again."""
    return shown_with(at.problem, at.names, at.x, at.covariance)


def shown_with(
    problem: Problem, names: tuple[str, ...], x: Array, covariance: Array
) -> dict[str, float]:
    """The same at a vector, in one linear step: the square of its strength over its variance."""
    places = {name: own.start for name, own in problem.places(names).items()}
    return {n: float(x[i] ** 2 / max(covariance[i, i], 1e-12)) for n, i in places.items()}


def at_bound(at: Candidate) -> tuple[str, ...]:
    """The effects of which a parameter has come to an end of its range.

    A share of one axle ends where the physics does: all of it is a result like any other. So does
    what is at its default: it need not be given.
    """
    return tuple(dict.fromkeys(name for name, _, _ in _ended(at)))


def pressed(at: Candidate) -> tuple[str, ...]:
    """The effects that a range holds: past its end a parameter would explain clearly more.

    In one linear step, with all parameters that are inside their ranges fitted again. Something
    else acts then than the effect as its card has it. A parameter that ends where it does nothing
    more, as the power of a motor that nothing limits, is not held.
    """
    ended = _ended(at)
    if not ended:
        return ()
    size = at.x.size
    J = _with_priors(at.problem, at.names, at.jacobian, size)
    rest = np.concatenate([joined(at.whitened), prior_rows(at.problem, at.names, at.x)])
    inside = np.ones(size, bool)
    inside[[place for _, place, _ in ended]] = False
    directions = np.linalg.qr(J[:, inside])[0]
    held = []
    for name, place, outward in ended:
        own = free(J[:, place], directions)
        along = float(own @ rest)
        gained = along**2 / max(float(own @ own), 1e-12)
        if -along * outward > 0.0 and gained > max(GATES.pressed, GATES.parameter * at.count):
            held.append(name)
    return tuple(dict.fromkeys(held))


def _ended(at: Candidate) -> list[tuple[str, int, float]]:
    """Effect, place in the vector and outward direction (1 or -1) of each ended parameter."""
    low, high = bounds(at.problem, at.names)
    margin = GATES.at_bound * np.minimum(high - low, GATES.usual_range)
    found = []
    for name, own in at.problem.places(at.names).items():
        parameters = definition(at.problem.vehicle.effects, name).card.parameters
        for place, p in zip(range(own.start, own.stop), parameters, strict=True):
            below, above = at.x[place] < (low + margin)[place], at.x[place] > (high - margin)[place]
            default = _is_default(p, at.effects.parameters[name][p.name])
            if (below or above) and not (p.share or default):
                found.append((name, place, 1.0 if above else -1.0))
    return found


def _is_default(parameter: Parameter, value: float) -> bool:
    if parameter.default is None:
        return False
    return abs(value - parameter.default) < GATES.at_bound * (parameter.high - parameter.low)


def divided(at: Candidate) -> tuple[str, ...]:
    """The effects that act on both axles in an odd share, as few cars' engines do."""
    return tuple(
        name
        for name in at.names
        for p in definition(at.problem.vehicle.effects, name).card.parameters
        if p.share
        and min(abs(at.effects.parameters[name][p.name] - x) for x in (p.low, p.high, p.typical))
        > GATES.divided
    )


def prior_rows(problem: Problem, names: tuple[str, ...], x: Array) -> Array:
    """Residuals of the weak priors; the strengths have none."""
    rows = [*(x[: problem.base_size] / problem.base_sigma)]
    for own in problem.places(names).values():
        rows += [float(v) / GATES.second_sigma for v in x[own][1:]]
    return np.asarray(rows)


def prior_derivatives(problem: Problem, names: tuple[str, ...], size: int) -> Array:
    """Derivatives (m, k) of `prior_rows`, which are linear in the vector (k,)."""
    rows = [prior_rows(problem, names, unit) for unit in np.eye(size)]
    return np.stack(rows, axis=1)


def _with_priors(problem: Problem, names: tuple[str, ...], J: Array, size: int) -> Array:
    """Derivatives (n + m, j) of innovations and priors from those (n, j) of the innovations."""
    return np.concatenate([J, prior_derivatives(problem, names, size)[:, : J.shape[1]]])


def widths(problem: Problem, size: int) -> Array:
    """Usual change of each element of the vector (``size``,), as a scale of steps."""
    others = problem.base_sigma[BASE:]
    return np.concatenate([np.full(BASE, 0.1), others, np.ones(size - problem.base_size)])


@dataclass(frozen=True)
class FreeTerm:
    """An empirical term whose values at its knots are fitted.

    ``make`` builds it from its values, of which there are ``size``, each up to ``limit``.
    """

    make: Callable[[Array], EmpiricalTerm]
    size: int
    limit: float


def fit(
    problem: Problem,
    names: tuple[str, ...],
    start: Array,
    steps: int = 20,
    term: FreeTerm | None = None,
    jacobian: Array | None = None,
    rough: bool = False,
) -> Candidate:
    """Fit base and effects from ``start`` (a vector of `unpack`).

    With a ``term``, its values at the knots are the last ones of the vector. A ``jacobian`` (n, j)
    of the innovations by its first elements is that of an explanation which this one goes on from.
    A ``rough`` fit ends after a few steps.
    """
    low, high = bounds(problem, names)
    knots, limit = (term.size, term.limit) if term else (0, 0.0)
    low = np.concatenate([low, np.full(knots, -limit)])
    high = np.concatenate([high, np.full(knots, limit)])
    own = low.size - knots

    def objective(x: Array) -> Array:
        base, effects = unpack(problem, names, x[:own])
        present = replace(effects, terms=(term.make(x[own:]),)) if term else effects
        # a prior on the bends of a term: it stays straight where the data do not need a bend
        bent = np.diff(x[own:]) / 0.5
        rows = [problem.flat(base, present), prior_rows(problem, names, x[:own]), bent]
        return np.concatenate([*rows, x[own:] / 2.0])

    first = np.clip(start, low + 1e-6, high - 1e-6)
    scale = np.concatenate([widths(problem, own), np.full(knots, 0.1)])
    known = None if jacobian is None else _with_priors(problem, names, jacobian, own)
    found = least_squares(objective, first, low, high, scale, steps, known, rough)
    priors = prior_rows(problem, names, found.x[:own]).size + (2 * knots - 1 if knots else 0)
    at = candidate_of(problem, names, found.x, found.residuals[:-priors])
    fall = float(found.residuals @ found.residuals) - found.promised
    return replace(at, promised=at.chi2 - fall)


def fit_base(problem: Problem) -> Candidate:
    """The model without effects, fitted from where it starts and once more from a higher peak.

    A tyre whose peak is below what a log asks of it is held there, and no small step of the peak
    explains that log better: a fit that comes from below can end at such a tyre. One from above
    counts where it explains clearly more.
    """
    usual = fit(problem, (), problem.start)
    start = usual.x.copy()
    start[PEAK_PLACE] += GATES.higher_peak
    above = fit(problem, (), start)
    return above if usual.chi2 - above.chi2 > GATES.pressed else usual


def candidate_of(
    problem: Problem, names: tuple[str, ...], x: Array, innovations: Array
) -> Candidate:
    """The explanation with a fitted vector, which leaves these ``innovations`` (n,)."""
    base, effects = unpack(problem, names, x)
    return Candidate(
        problem=problem,
        names=names,
        base=base,
        effects=effects,
        x=x,
        chi2=float(innovations @ innovations),
        promised=float(innovations @ innovations),
        count=innovations.size,
        scatter=float(
            np.sqrt(2.0 / innovations.size + 2.0 / (len(CHANNELS) * problem.noise.freedom))
        ),
    )


def fit_without(at: Candidate, name: str) -> Candidate:
    """An explanation fitted anew without one of its effects; once for each."""
    if name not in at.fewer:
        at.fewer[name] = _fitted_without(at, name)
    return at.fewer[name]


def _fitted_without(at: Candidate, name: str) -> Candidate:
    places = {n: own for n, own in at.problem.places(at.names).items() if n != name}
    kept = [at.x[: at.problem.base_size], *(at.x[own] for own in places.values())]
    return fit(at.problem, tuple(places), np.concatenate(kept))
