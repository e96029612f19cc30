"""What is to be explained: all runs of a case, their noise, and what is known of the car."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from calib.base.processes import Mapped
from calib.car.effects.body import AERODYNAMIC_DRAG
from calib.car.effects.effects import Effects
from calib.car.own_effects.own_effect import definition
from calib.car.vehicle import Vehicle
from calib.diagnosis.explanation.base import BASE, BASE_SIGMA, RADIUS_SIGMA, Base, Ground, base_of
from calib.diagnosis.explanation.channels import (
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
from calib.diagnosis.explanation.secant import columns
from calib.diagnosis.gates import GATES

Array = NDArray[np.float64]

DRAG, SHARE = "aerodynamic_drag", "load_share"

_SHARE = {p.name: p for p in AERODYNAMIC_DRAG.card.parameters}[SHARE]

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


def problem_of(
    vehicle: Vehicle, runs: list[ObservedRun], tell: Tell = silent, mapped: Mapped = map
) -> Problem:
    """Build a problem; its noise is that of the unbraked parts, where no base parameter acts."""
    nominal = base_of(vehicle, np.zeros(BASE))
    noise = unbraked_noise(vehicle, nominal, vehicle.effects, runs)
    turned = tuple(turned_to_ripple(vehicle, nominal, run, noise) for run in runs)
    return Problem(vehicle, turned, noise, tell, mapped=mapped)


def unbraked_noise(
    vehicle: Vehicle, base: Base, effects: Effects, runs: Sequence[ObservedRun]
) -> ChannelNoise:
    """Noise of the channels in the unbraked parts, of what an explanation leaves there."""
    wholes = [residuals(run, predict(vehicle, base, effects, run)) for run in runs]
    pairs = zip(runs, wholes, strict=True)
    return noise_of([whole[:, : unbraked_length(run)] for run, whole in pairs], wholes)


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
