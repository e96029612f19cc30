"""A candidate explanation: the base parameters and some effects, fitted to all runs together."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.car.effects.effects import Effects
from calib.diagnosis.explanation.base import Base
from calib.diagnosis.explanation.channels import CHANNELS
from calib.diagnosis.explanation.problem import Problem, joined, unbraked_noise
from calib.diagnosis.explanation.secant import columns
from calib.diagnosis.explanation.vector import bounds, prior_derivatives, unpack
from calib.diagnosis.gates import GATES

Array = NDArray[np.float64]


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


def shown(at: Candidate) -> dict[str, float]:
    """What the chi-square would rise by without each effect, all else fitted again."""
    return shown_with(at.problem, at.names, at.x, at.covariance)


def shown_with(
    problem: Problem, names: tuple[str, ...], x: Array, covariance: Array
) -> dict[str, float]:
    """The same at a vector, in one linear step: the square of its strength over its variance."""
    places = {name: own.start for name, own in problem.places(names).items()}
    return {n: float(x[i] ** 2 / max(covariance[i, i], 1e-12)) for n, i in places.items()}


def without_its_noise(best: Candidate) -> Problem | None:
    """The problem with the noise that is left with an explanation, None if that is no quieter.

    An effect that acts in unbraked parts, such as a tone ring that runs out, was part of the noise.
    """
    problem = best.problem
    noise = unbraked_noise(problem.vehicle, best.base, best.effects, problem.runs)
    if np.all(noise.sigma > GATES.quieter * problem.noise.sigma):
        return None
    return replace(problem, noise=noise)
