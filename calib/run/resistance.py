"""Drag and rolling resistance from coasting: the effects known before any pad is judged.

Unbraked, the force balance (5) with (1) reads

    W z - sum(J d omega/dt)/R = 1/2 rho c_d A v^2 + c_rr W

Each log gives it over the speeds it coasted through. One short lead-in fixes the sum at one speed
and leaves the share to what is usual (the cards' typical values); a coast log over a wide range of
speeds separates them. Wrong when the engine drives or brakes, on a slope the accelerometer does not
see, or in wind.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.car.effects.body import AERODYNAMIC_DRAG, AIR_DENSITY
from calib.car.effects.effects import Effects
from calib.car.effects.wheels import ROLLING_RESISTANCE
from calib.car.model import default_model
from calib.car.vehicle import Vehicle
from calib.run.blocks import Blocks, block_balance

_MODEL_ERROR = 3e-4
"""What a coast can be off in z for reasons not modelled: wind, road crown, a warm gearbox [1]."""
_CARDS = (AERODYNAMIC_DRAG.card, ROLLING_RESISTANCE.card)
DRAG, ROLLING = ((card.name, card.parameters[0].name) for card in _CARDS)
"""Effect and parameter that are looked for."""
RESISTANCE = (DRAG[0], ROLLING[0])
"""Names of the two effects."""


@dataclass(frozen=True)
class Resistance:
    """Drag and rolling resistance, and what else is known to slow body or wheels.

    Attributes
    ----------
    effects : all of them, drag area [m^2] and rolling coefficient [1] among them.
    covariance : of these two, (2, 2).
    specified : whether the vehicle file gave both.
    """

    effects: Effects
    covariance: tuple[tuple[float, ...], ...]
    specified: bool = False

    @property
    def mean(self) -> tuple[float, float]:
        """Drag area [m^2] and rolling coefficient [1]."""
        drag, rolling = (self.effects.parameters[effect][name] for effect, name in (DRAG, ROLLING))
        return drag, rolling

    def sigma_z(self, vehicle: Vehicle, v: Array) -> Array:
        """Standard deviation of the resistance at speed ``v`` [m/s], as a deceleration [1]."""
        gain = np.stack([_drag_gain(vehicle, v), np.ones_like(v)], axis=-1)
        variance = np.einsum("...i,ij,...j->...", gain, np.asarray(self.covariance), gain)
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))


def identify(vehicle: Vehicle, runs: Iterable[tuple[Blocks, float]]) -> Resistance:
    """Drag and rolling resistance from the unbraked blocks of ``runs``.

    Each run comes with the noise density of its z [s^0.5]. Values of the vehicle file are kept,
    whatever the runs say; its other effects are taken out first. The result is the most probable
    one under a Gaussian on the cards' typical values, within the cards' ranges; the covariance is
    that of the uncut Gaussian.

    Raises ModelError if the vehicle names an effect or parameter that the catalogue does not know,
    or a value out of its range.
    """
    effects = default_model(vehicle).effects
    others = effects.without(*RESISTANCE)
    priors = [card.parameters[0] for card in _CARDS]
    specified = [effects.parameters.get(name, {}).get(p) for name, p in (DRAG, ROLLING)]
    centre = [p.typical if g is None else g for p, g in zip(priors, specified, strict=True)]
    # a given value is still a measured one: 2 % of the usual spread keeps the algebra regular
    spread = [
        p.spread * (1.0 if g is None else 0.02) for p, g in zip(priors, specified, strict=True)
    ]
    rows, sides = [np.diag(1.0 / np.asarray(spread))], [np.asarray(centre) / np.asarray(spread)]
    for b, density in runs:
        use = b.lead_in & (b.speed > 3.0)
        count = int(use.sum())
        if count < 4:
            continue
        resist = (block_balance(vehicle, others, b).demanded / vehicle.weight)[use]
        gain = np.column_stack([_drag_gain(vehicle, b.speed[use]), np.ones(count)])
        # white within a run by density; the error not modelled is common to the run
        sigma = np.sqrt(density**2 / b.length + count * _MODEL_ERROR**2)
        rows.append(gain / sigma)
        sides.append(resist / sigma)
    A, y = np.vstack(rows), np.concatenate(sides)
    solution, free = np.asarray(centre), np.asarray([g is None for g in specified])
    if np.any(free):
        low, high = np.asarray([(p.low - 1e-12, p.high) for p in priors])[free].T
        residual = y - A[:, ~free] @ solution[~free]
        solution[free] = _bounded(A[:, free], residual, low, high)
    covariance = np.linalg.inv(A.T @ A)
    values, errors = np.maximum(solution, 0.0).tolist(), np.sqrt(np.diag(covariance)).tolist()
    parameters = {effect: {**effects.parameters.get(effect, {})} for effect in RESISTANCE}
    sigmas = {effect: dict.fromkeys(parameters[effect], 0.0) for effect in RESISTANCE}
    for (effect, name), value, error in zip((DRAG, ROLLING), values, errors, strict=True):
        parameters[effect][name], sigmas[effect][name] = value, error
    return Resistance(
        effects=others.with_(Effects(parameters, sigma=sigmas)),
        covariance=tuple(tuple(row) for row in covariance.tolist()),
        specified=all(g is not None for g in specified),
    )


def _bounded(A: Array, y: Array, low: Array, high: Array) -> Array:
    """Least squares solution (k,) within bounds; without scipy.optimize where these do nothing."""
    solution = np.linalg.lstsq(A, y, rcond=-1)[0]
    if np.all((solution >= low) & (solution <= high)):
        return np.asarray(solution)
    from scipy.optimize import lsq_linear

    return np.asarray(lsq_linear(A, y, bounds=(low, high)).x)


def _drag_gain(vehicle: Vehicle, v: Array) -> Array:
    return 0.5 * AIR_DENSITY * v**2 / vehicle.weight
