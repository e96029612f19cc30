"""What is to be explained: all runs of a case, their noise, and what is known of the car."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from calib.base.arrays import Array
from calib.base.names import G
from calib.base.processes import MapFunction
from calib.car.braking import BITE
from calib.car.effects.effects import Effects
from calib.car.vehicle import Vehicle
from calib.diagnosis.explanation.base import BASE, Base, base_of
from calib.diagnosis.explanation.channels import (
    A_X,
    CHANNELS,
    DRIFT,
    FRONT_REAR,
    ChannelNoise,
    noise_of,
    residuals,
    thinned,
    whiten,
)
from calib.diagnosis.explanation.predict import ObservedRun, predict

_COASTING = 1e5  # weight of a ripple without torque, as a pressure [Pa]: little beside a braked one
_MARGIN = 8  # steps of evidence before the brake first bites that do not count as unbraked

Tell = Callable[[str, int, int], None]
"""Called at each step: the stage in words, how many of its steps are done, how many it has."""


def silent(stage: str, step: int, total: int) -> None:
    """Tell nobody of the progress."""


@dataclass(frozen=True)
class Problem:
    """All runs of a case and their noise; the effects of ``vehicle`` act in every hypothesis.

    ``tell`` is told of the progress, ``mapped`` carries out independent pieces of work.
    """

    vehicle: Vehicle
    runs: tuple[ObservedRun, ...]
    noise: ChannelNoise
    tell: Tell = silent
    mapped: MapFunction = map

    @property
    def alone(self) -> Self:
        """The same for a worker process, which tells nobody and has no workers of its own."""
        return replace(self, tell=silent, mapped=map)

    @cached_property
    def courses(self) -> list[Array]:
        """What a slope [1] and a zero of a_x [m/s^2] of its own do to the innovations, (2, n).

        v falls by g s t more than the forces say, for the slope's sine s, uphill positive, and a_x,
        which is specific force, does not move (Gillespie, Fundamentals of Vehicle Dynamics, ch. 1).
        """
        columns = []
        for time in (thinned(run, run.time) for run in self.runs):
            changed = np.zeros((2, len(CHANNELS), time.size))
            changed[0, DRIFT] = G * (time - time[0])
            changed[1, A_X] = -1.0
            columns.append(whiten(changed, self.noise))
        return columns


def problem_of(
    vehicle: Vehicle, runs: Sequence[ObservedRun], tell: Tell = silent, mapped: MapFunction = map
) -> Problem:
    """Build a problem; its noise is that of the unbraked parts, where no base parameter acts."""
    noise = unbraked_noise(vehicle, base_of(vehicle, np.zeros(BASE)), vehicle.effects, runs)
    return Problem(vehicle, turned(vehicle, runs, noise), noise, tell, mapped)


def turned(
    vehicle: Vehicle, runs: Sequence[ObservedRun], noise: ChannelNoise
) -> tuple[ObservedRun, ...]:
    """The runs with the origin of their wheel angles by the phase of the ripple of each.

    Where the front torque is high, the car and its front wheels slow: a_x and front less rear go
    with -sin(angle). A sensor that ripples does so without torque too, in front less rear alone:
    there `_COASTING` counts besides. The ripple that is looked for is whitened as the residuals
    are, for a filter delays fast turns and slow ones differently.
    """
    base, out = base_of(vehicle, np.zeros(BASE)), []
    for run in runs:
        torque = np.maximum(thinned(run, run.p_mc), 0.0)
        looked_for = np.zeros((len(CHANNELS), torque.size), complex)
        turn = np.exp(1j * thinned(run, run.angle_f))
        looked_for[A_X], looked_for[FRONT_REAR] = torque * turn, (torque + _COASTING) * turn
        r = residuals(run, predict(vehicle, base, vehicle.effects, run))
        ripple = np.sum(whiten(r, noise) * whiten(looked_for, noise))
        out.append(replace(run, angle_f=run.angle_f - float(np.angle(ripple)) - 0.5 * np.pi))
    return tuple(out)


def unbraked_noise(
    vehicle: Vehicle, base: Base, effects: Effects, runs: Sequence[ObservedRun]
) -> ChannelNoise:
    """Noise of the channels in the unbraked parts, of what an explanation leaves there."""
    wholes = [residuals(run, predict(vehicle, base, effects, run)) for run in runs]
    braked = [np.flatnonzero(thinned(run, run.p_mc) > 0.5 * BITE) for run in runs]
    pairs = zip(wholes, braked, strict=True)
    return noise_of([x[:, : max(k[0] - _MARGIN, 0)] if k.size else x for x, k in pairs], wholes)
