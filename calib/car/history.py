"""A run as input of the effects: its history, its state, and the temperature of its discs."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.car.lag import first_order

HEAT_CAPACITY = {"f": 3700.0, "r": 2300.0}
"""Of the discs of a medium sedan [J/K]: 8 kg vented in front, 5 kg solid behind, of grey cast iron
with 460 J/(kg K)."""

_COOLING_TIME = 300.0
"""Time constant [s] by 0.13 m^2 and 60 to 100 W/(m^2 K), 280 to 470 s in front; in a stop of 10 s
it takes 2 % of the rise."""

START_TEMP = 100.0
"""Temperature of a disc at the first sample [degC] if not logged: the upper end of cold brakes in
UN R13-H, annex 3 (65 to 100 degC)."""

COLD = (START_TEMP, START_TEMP)


@dataclass(frozen=True)
class RunHistory:
    """A run over time, for effects that depend on the past; arrays (n,), SI.

    ``time`` [s], increasing; ``v`` [m/s]; ``z`` deceleration over g [1]; ``p_mc`` [Pa];
    ``temperature_f``, ``temperature_r`` of the discs [degC], None where not known; ``angle_f``,
    ``angle_r`` wheel angle since the first sample [rad]; ``energy_f``, ``energy_r`` dissipated in
    one brake of the axle since the first sample [J]; ``source`` the log or the simulation, for
    messages; ``start_heat`` temperature of the front and the rear discs at the first sample
    [degC], where it is not logged; ``averaged`` number of samples of which each one is the mean.
    """

    time: Array
    v: Array
    z: Array
    p_mc: Array
    temperature_f: Array | None
    temperature_r: Array | None
    angle_f: Array
    angle_r: Array
    energy_f: Array
    energy_r: Array
    source: str = ""
    start_heat: tuple[float, float] = COLD
    averaged: int = 1

    def ripple(self, phase: float) -> Array:
        """sin(front wheel angle + ``phase``) [1] (n,), averaged as the samples are.

        The mean of m even samples over the angle a is sin(a/2)/(m sin(a/(2 m))) of the middle one.
        """
        wave = np.sin(self.angle_f + phase)
        if self.averaged == 1 or wave.size < 2:
            return wave
        half = 0.5 * np.gradient(self.angle_f)
        divisor = self.averaged * np.sin(half / self.averaged)
        standing = np.abs(divisor) < 1e-12
        return wave * np.where(standing, 1.0, np.sin(half) / np.where(standing, 1.0, divisor))


@dataclass(frozen=True)
class Motion:
    """The state that an effect may depend on; arrays of one shape.

    ``v`` [m/s]; ``load_f``, ``load_r`` axle loads [N]; ``history`` the run so far.
    """

    v: Array
    load_f: Array
    load_r: Array
    history: RunHistory


def constant_speed(
    time: Array,
    p_mc: Array,
    v0: float,
    temperature: Mapping[str, Array] | None = None,
    source: str = "",
    start_heat: tuple[float, float] = COLD,
) -> RunHistory:
    """A run at the constant speed ``v0`` [m/s]: only pressure and temperatures are known.

    ``time`` [s], ``p_mc`` [Pa], ``temperature`` [degC] by axle (n,); angles and energies are zero.
    """
    by_axle, zero = temperature or {}, np.zeros_like(time)
    return RunHistory(
        time=time,
        v=np.full_like(time, v0),
        z=zero,
        p_mc=p_mc,
        temperature_f=by_axle.get("f"),
        temperature_r=by_axle.get("r"),
        angle_f=zero,
        angle_r=zero,
        energy_f=zero,
        energy_r=zero,
        source=source,
        start_heat=start_heat,
    )


_AIR = 20.0
"""Temperature of the air [degC]."""


def disc_temperature(time: Array, energy: Array, heat_capacity: float, start: float) -> Array:
    """Temperature of one disc of ``heat_capacity`` C [J/K] [degC] (n,), ``start`` [degC] at first.

    C dT/dt = P - (C/tau) (T - T_air): heated by the whole braking power, cooled by the air
    (Limpert, Brake Design and Safety, ch. 3, lumped disc). ``time`` [s] (n,); ``energy`` E [J] (n,)
    dissipated in this brake since the first sample, linear between samples. The stored heat is E
    less its first-order lag. Not valid for the surface of the disc in a hard stop, nor over minutes
    of changing speed: pads take no heat, and cooling does not depend on speed.
    """
    stored = energy - first_order(time, energy, _COOLING_TIME)
    initial = np.exp(-(time - time[0]) / _COOLING_TIME)
    return np.asarray(_AIR + (start - _AIR) * initial + stored / heat_capacity)
