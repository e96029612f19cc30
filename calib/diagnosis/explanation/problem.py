"""The problem of a diagnosis: all runs of a case, their noise, and the known car."""

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
from calib.diagnosis.explanation import channels
from calib.diagnosis.explanation.channels import ChannelNoise, residuals, thinned, whiten
from calib.diagnosis.explanation.predict import ObservedRun, predict
from calib.diagnosis.explanation.unknowns import BASE_SIZE, Base, base_of

_COASTING = 1e5  # added to the pressure, so that a ripple without torque has a phase, too [Pa]
_MARGIN = 8  # samples before the brake first bites that do not count as unbraked

Tell = Callable[[str, int, int], None]
"""Function called at each step: the stage in words, the steps done, the number of all steps."""


def silent(stage: str, step: int, total: int) -> None:
    """Do not report progress."""


@dataclass(frozen=True)
class Problem:
    """What a hypothesis is fitted to."""

    vehicle: Vehicle  # with effects that act in every hypothesis
    runs: tuple[ObservedRun, ...]
    noise: ChannelNoise
    tell: Tell = silent  # reports the progress
    mapped: MapFunction = map  # a `map` that may work in several processes

    @property
    def for_worker(self) -> Self:
        """The problem for a worker process, which reports nothing and starts no processes."""
        return replace(self, tell=silent, mapped=map)

    @cached_property
    def offset_columns(self) -> list[Array]:
        """Derivatives (2, n) of the innovations of each run by its slope [1] and zero [m/s^2].

        n counts the whitened samples of all channels. The slope is the sine s of the road's angle,
        uphill positive: v falls by a further g s t, which the prediction lacks, but a_x, the
        specific force, does not change (Gillespie, Fundamentals of Vehicle Dynamics, ch. 1).
        """
        columns = []
        for run in self.runs:
            time = thinned(run, run.time)
            by_offsets = np.zeros((2, len(channels.CHANNELS), time.size))  # of the residuals
            by_offsets[0, channels.SPEED] = G * (time - time[0])
            by_offsets[1, channels.A_X] = -1.0
            columns.append(whiten(by_offsets, self.noise))
        return columns


def problem_of(
    vehicle: Vehicle, runs: Sequence[ObservedRun], tell: Tell = silent, mapped: MapFunction = map
) -> Problem:
    """Build a problem with the noise of the unbraked parts, where base parameters hardly act."""
    usual_base = base_of(vehicle, np.zeros(BASE_SIZE))
    noise = unbraked_noise(vehicle, usual_base, vehicle.effects, runs)
    return Problem(vehicle, with_ripple_phase(vehicle, runs, noise), noise, tell, mapped)


def with_ripple_phase(
    vehicle: Vehicle, runs: Sequence[ObservedRun], noise: ChannelNoise
) -> tuple[ObservedRun, ...]:
    """Return the runs with front wheel angles such that the front torque ripples as sin(angle).

    Where the front torque is high, the car and its front wheels slow, so the channels a_x and
    front_rear go with -sin(angle). The ripple of a tone ring shows without torque, too, but in
    front_rear alone. The waves are whitened as the residuals are, since the delay of the whitening
    filter depends on the frequency.
    """
    base, shifted = base_of(vehicle, np.zeros(BASE_SIZE)), []
    for run in runs:
        pressure = np.maximum(thinned(run, run.p_mc), 0.0)  # stands for the torque
        turn = np.exp(1j * thinned(run, run.angle_f))
        waves = np.zeros((len(channels.CHANNELS), pressure.size), complex)
        waves[channels.A_X] = pressure * turn
        waves[channels.FRONT_REAR] = (pressure + _COASTING) * turn
        r = residuals(run, predict(vehicle, base, vehicle.effects, run))
        # residuals that go with -sin(angle + phase) give this sum the angle -phase - pi/2
        ripple = np.sum(whiten(r, noise) * whiten(waves, noise))
        angle_f = run.angle_f - float(np.angle(ripple)) - 0.5 * np.pi
        shifted.append(replace(run, angle_f=angle_f))
    return tuple(shifted)


def unbraked_noise(
    vehicle: Vehicle, base: Base, effects: Effects, runs: Sequence[ObservedRun]
) -> ChannelNoise:
    """Noise of the channels, by the residuals of ``base`` and ``effects`` in the unbraked parts."""
    whole = [residuals(run, predict(vehicle, base, effects, run)) for run in runs]
    unbraked = []
    for run, r in zip(runs, whole, strict=True):
        braked = np.flatnonzero(thinned(run, run.p_mc) > 0.5 * BITE)
        unbraked.append(r[:, : max(braked[0] - _MARGIN, 0)] if braked.size else r)
    return channels.noise_of(unbraked, whole)
