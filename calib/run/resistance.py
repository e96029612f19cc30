"""Drag and rolling resistance from coasting, by the force balance (5) with (1), unbraked.

    W z - sum(J d omega/dt)/R = 1/2 rho c_d A v^2 + c_rr W

The prior is that of the effects' cards: typical values, spreads and ranges. A short lead-in fixes
the sum of drag and rolling at one speed and leaves their shares to the prior; a coast over a wide
range of speeds separates them. Wrong when the engine drives or brakes, and in wind.
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

_MODEL_ERROR = 3e-4  # error of z of a coast by wind, road crown or a warm gearbox [1]
_CARDS = (AERODYNAMIC_DRAG.card, ROLLING_RESISTANCE.card)
DRAG, ROLLING = ((card.name, card.parameters[0].name) for card in _CARDS)
"""Name of the effect, and of its parameter that is estimated: drag area and rolling coefficient."""
RESISTANCE = (DRAG[0], ROLLING[0])
_FIXED = 0.02  # sigma of a value that the vehicle file gives, over the spread of the prior [1]


@dataclass(frozen=True)
class Resistance:
    """Drag and rolling resistance, estimated or of the vehicle file."""

    effects: Effects  # all effects of the vehicle, with drag and rolling resistance
    covariance: tuple[tuple[float, ...], ...]  # of drag area [m^2] and coefficient [1], (2, 2)
    specified: bool = False  # whether the vehicle file gave both

    @property
    def mean(self) -> tuple[float, float]:
        """Drag area [m^2] and rolling coefficient [1]."""
        values = self.effects.parameters
        return values[DRAG[0]][DRAG[1]], values[ROLLING[0]][ROLLING[1]]

    def sigma_z(self, vehicle: Vehicle, v: Array) -> Array:
        """Standard deviation of the resistance at speed ``v`` [m/s], as a deceleration [1]."""
        gain = np.stack([_drag_gain(vehicle, v), np.ones_like(v)], axis=-1)  # (..., 2)
        variance = np.einsum("...i,ij,...j->...", gain, np.asarray(self.covariance), gain)
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))


def identify(vehicle: Vehicle, runs: Iterable[tuple[Blocks, float]]) -> Resistance:
    """Estimate drag and rolling resistance from lead-ins: blocks and noise density of z [s^0.5].

    Values of the vehicle file stay, and its other effects are removed first. The result is the
    posterior mode within the ranges of the cards, with a Gaussian prior at their typical values;
    the covariance ignores the ranges. Raises ModelError for unknown or impossible effects.
    """
    effects = default_model(vehicle).effects
    others = effects.without(*RESISTANCE)
    priors = [card.parameters[0] for card in _CARDS]
    specified = [effects.parameters.get(effect, {}).get(name) for effect, name in (DRAG, ROLLING)]
    free = np.asarray([value is None for value in specified])
    solution = np.asarray(
        [p.typical if value is None else value for p, value in zip(priors, specified, strict=True)]
    )
    spread = np.asarray([p.spread for p in priors]) * np.where(free, 1.0, _FIXED)
    equations = [(np.diag(1.0 / spread), solution / spread)]  # of the prior
    equations += [_equations(vehicle, others, b, density) for b, density in runs]
    A, y = (np.concatenate(part) for part in zip(*equations, strict=True))
    if np.any(free):
        # 1e-12: a value that is below its range by rounding alone makes no bound active
        low, high = np.asarray([(p.low - 1e-12, p.high) for p in priors])[free].T
        residual = y - A[:, ~free] @ solution[~free]
        solution[free] = _bounded(A[:, free], residual, low, high)
    covariance = np.linalg.inv(A.T @ A)
    values, errors = np.maximum(solution, 0.0).tolist(), np.sqrt(np.diag(covariance)).tolist()
    parameters: dict[str, dict[str, float]] = {}
    sigmas: dict[str, dict[str, float]] = {}
    for (effect, name), value, error in zip((DRAG, ROLLING), values, errors, strict=True):
        of_file = effects.parameters.get(effect, {})
        parameters[effect] = {**of_file, name: value}
        sigmas[effect] = {**dict.fromkeys(of_file, 0.0), name: error}
    return Resistance(
        effects=others.with_(Effects(parameters, sigma=sigmas)),
        covariance=tuple(tuple(row) for row in covariance.tolist()),
        specified=not np.any(free),
    )


def _equations(vehicle: Vehicle, others: Effects, b: Blocks, density: float) -> tuple[Array, Array]:
    """Equations A x = y by the k blocks of a lead-in, with errors of sigma 1: A (k, 2), y (k,)."""
    use = b.lead_in & (b.speed > 3.0)
    count = int(use.sum())
    if count < 4:
        return np.empty((0, 2)), np.empty(0)
    resistance = (block_balance(vehicle, others, b).demanded / vehicle.weight)[use]
    gain = np.column_stack([_drag_gain(vehicle, b.speed[use]), np.ones(count)])
    # noise is white; the error of the model is common to a run, so its blocks count as one
    sigma = np.sqrt(density**2 / b.length + count * _MODEL_ERROR**2)
    return gain / sigma, resistance / sigma


def _bounded(A: Array, y: Array, low: Array, high: Array) -> Array:
    """Least squares (k,) within bounds; scipy.optimize is imported only where a bound is active."""
    solution = np.linalg.lstsq(A, y, rcond=-1)[0]
    if np.all((solution >= low) & (solution <= high)):
        return np.asarray(solution)
    from scipy.optimize import lsq_linear

    return np.asarray(lsq_linear(A, y, bounds=(low, high)).x)


def _drag_gain(vehicle: Vehicle, v: Array) -> Array:
    """Deceleration [1] that a drag area of 1 m^2 makes at speed ``v`` [m/s]."""
    return 0.5 * AIR_DENSITY * v**2 / vehicle.weight
