"""A run as input of the effects: its history, its motion, and the temperature of its discs."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.car.lag import first_order

HEAT_CAPACITY = {"f": 3700.0, "r": 2300.0}
"""Heat capacity [J/K] of a front and a rear disc of a medium sedan: 8 kg vented in front, 5 kg
solid behind, of grey cast iron with 460 J/(kg K)."""

_COOLING_TIME = 300.0
"""Time constant [s] of the cooling of a disc. A front disc of 0.13 m^2 with 60 to 100 W/(m^2 K) has
280 to 470 s. In a stop of 10 s, cooling takes 2 % of the rise in temperature."""

START_TEMP = 100.0
"""Temperature of a disc at the first sample [degC] if not logged: the upper end of cold brakes in
UN R13-H, annex 3 (65 to 100 degC)."""

COLD = (START_TEMP, START_TEMP)  # front and rear
_AIR = 20.0  # temperature of the air [degC]


@dataclass(frozen=True)
class RunHistory:
    """A run over time; arrays (n,)."""

    time: Array  # [s], increasing
    v: Array  # speed [m/s]
    z: Array  # deceleration over g [1]
    p_mc: Array  # master-cylinder pressure [Pa]
    temperature_f: Array | None  # of the discs [degC], None where not known
    temperature_r: Array | None
    angle_f: Array  # of the wheels since the first sample [rad]
    angle_r: Array
    energy_f: Array  # dissipated in one brake of the axle since the first sample [J]
    energy_r: Array
    source: str = ""  # name of the log or the simulation, for messages
    start_heat: tuple[float, float] = COLD  # first temperature of discs, if not logged [degC]
    averaged: int = 1  # each sample is the mean of this number m of raw samples

    def ripple(self, phase: float) -> Array:
        """sin(front wheel angle + ``phase``) [1] (n,), averaged as the samples are.

        The mean of the sine over m evenly spaced samples that span the angle a is the sine at their
        middle, multiplied by sin(a/2)/(m sin(a/(2 m))).
        """
        wave = np.sin(self.angle_f + phase)
        if self.averaged == 1 or wave.size < 2:
            return wave
        half_angle = 0.5 * np.gradient(self.angle_f)  # a/2
        divisor = self.averaged * np.sin(half_angle / self.averaged)
        is_at_rest = np.abs(divisor) < 1e-12
        factor = np.sin(half_angle) / np.where(is_at_rest, 1.0, divisor)
        return wave * np.where(is_at_rest, 1.0, factor)


@dataclass(frozen=True)
class Motion:
    """State on which a force or moment depends: speed [m/s], axle loads [N], ``history``."""

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
    """Return a run at the speed ``v0`` [m/s], whose angles, energies and deceleration are zero.

    ``time`` [s], ``p_mc`` [Pa] and ``temperature`` [degC], by axle "f" and "r", are (n,).
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


def disc_temperature(time: Array, energy: Array, heat_capacity: float, start: float) -> Array:
    """Return the temperature T [degC] (n,) of one disc that begins at ``start`` [degC].

    ``time`` [s] (n,); ``energy`` E [J] (n,) dissipated in this brake since the first sample, linear
    between samples; ``heat_capacity`` C [J/K]. The braking power P heats the whole disc and the air
    cools it with the time constant tau: C dT/dt = P - (C/tau) (T - T_air) (Limpert, Brake Design
    and Safety, ch. 3, lumped disc). So the stored heat is E less the first-order lag of E. Not
    valid for the surface of the disc in a hard stop, nor over minutes of changing speed: pads take
    no heat here, and cooling does not depend on speed.
    """
    stored = energy - first_order(time, energy, _COOLING_TIME)
    decay = np.exp(-(time - time[0]) / _COOLING_TIME)
    return np.asarray(_AIR + (start - _AIR) * decay + stored / heat_capacity)
