"""Drag and rolling resistance from coasting: the effects known before any pad is judged.

Unbraked, the force balance (5) with (1) reads

    W z - sum(J d omega/dt)/R = 1/2 rho c_d A v^2 + c_rr W

Each log gives it over the speeds it coasted through. One short lead-in fixes the sum at one speed
and leaves the share to what is usual (the cards' typical values); a coast log over a wide range of
speeds separates them. Wrong when the engine drives or brakes, on a slope the accelerometer does not
see, or in wind.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from calib.physics.balance import force_balance
from calib.physics.effects import aerodynamic_drag, rolling_resistance
from calib.physics.effects.aerodynamic_drag import AIR_DENSITY
from calib.physics.effects.catalogue import Effects
from calib.physics.effects.effect import Parameters
from calib.physics.effects.empirical import Empirical
from calib.physics.model import TERM, default_model
from calib.physics.vehicle import Vehicle
from calib.signals.blocks import Blocks

Array = NDArray[np.float64]

MODEL_ERROR = 3e-4
"""What a coast can be off in z for reasons not modelled: wind, road crown, a warm gearbox [1]."""


@dataclass(frozen=True)
class Resistance:
    """Drag area [m^2] and rolling coefficient [1]: ``mean`` (2,) and ``covariance`` (2, 2).

    ``known`` is true where the vehicle file gave both; ``others`` is what else is known to slow
    body or wheels.
    """

    mean: tuple[float, float]
    covariance: tuple[tuple[float, float], tuple[float, float]]
    known: bool = False
    others: Effects = field(default_factory=dict)

    @property
    def effects(self) -> dict[str, Parameters | Empirical]:
        """All that slows body or wheels, as the catalogue takes it."""
        return {
            **self.others,
            **self.found,
        }

    @property
    def found(self) -> dict[str, Parameters]:
        """The two effects that are looked for."""
        return {
            "aerodynamic_drag": {"drag_area": self.mean[0]},
            "rolling_resistance": {"coefficient": self.mean[1]},
        }

    def sigma_z(self, vehicle: Vehicle, v: Array) -> Array:
        """Standard deviation of the resistance at speed ``v`` [m/s], as a deceleration [1]."""
        gain = np.stack([_drag_gain(vehicle, v), np.ones_like(v)], axis=-1)
        variance = np.einsum("...i,ij,...j->...", gain, np.asarray(self.covariance), gain)
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))


def other_known_effects(vehicle: Vehicle, empirical: Empirical | None) -> Effects:
    """What is known to slow body or wheels besides drag and rolling resistance."""
    names = (aerodynamic_drag.EFFECT.card.name, rolling_resistance.EFFECT.card.name)
    others = {n: p for n, p in vehicle.effects.items() if n not in names}
    if empirical is None or empirical.on_brakes:
        return others
    return {**others, TERM: empirical}


def identify(
    vehicle: Vehicle, runs: list[tuple[Blocks, float]], empirical: Empirical | None = None
) -> Resistance:
    """Drag and rolling resistance from the unbraked blocks of ``runs``.

    Each run comes with the noise density of its z [s^0.5]. Values of the vehicle file are kept,
    whatever the runs say; its other effects, and an empirical term, are taken out first. The answer
    is the most probable one under a Gaussian on the cards' typical values, within the cards'
    ranges; the covariance is that of the uncut Gaussian.

    Raises ModelError if the vehicle names an effect or parameter that the catalogue does not know,
    or a value out of its range.
    """
    from scipy.optimize import lsq_linear

    effects = default_model(vehicle).effects
    others = other_known_effects(vehicle, empirical)
    cards = (aerodynamic_drag.EFFECT.card, rolling_resistance.EFFECT.card)
    priors = [card.parameters[0] for card in cards]
    given = [effects.get(card.name, {}).get(p.name) for card, p in zip(cards, priors, strict=True)]
    centre = [p.typical if g is None else g for p, g in zip(priors, given, strict=True)]
    # a given value is still a measured one: 2 % of the usual spread keeps the algebra regular
    spread = [p.spread * (1.0 if g is None else 0.02) for p, g in zip(priors, given, strict=True)]
    rows, sides = [np.diag(1.0 / np.asarray(spread))], [np.asarray(centre) / np.asarray(spread)]
    for b, density in runs:
        use = b.lead_in & (b.speed > 3.0)
        count = int(use.sum())
        if count < 4:
            continue
        spin = (b.spin_f, b.spin_r)
        forces = force_balance(vehicle, others, b.end, b.speed, b.z, b.p_f, spin)
        resist = (forces.demanded / vehicle.weight)[use]
        gain = np.column_stack([_drag_gain(vehicle, b.speed[use]), np.ones(count)])
        # white within a run by density; the error not modelled is common to the run
        sigma = np.sqrt(density**2 / b.length + count * MODEL_ERROR**2)
        rows.append(gain / sigma)
        sides.append(resist / sigma)
    A, y = np.vstack(rows), np.concatenate(sides)
    solution, free = np.asarray(centre), np.asarray([g is None for g in given])
    if np.any(free):
        low, high = np.asarray([(p.low - 1e-12, p.high) for p in priors])[free].T
        rest = y - A[:, ~free] @ solution[~free]
        solution[free] = lsq_linear(A[:, free], rest, bounds=(low, high)).x
    covariance = np.linalg.inv(A.T @ A)
    return Resistance(
        mean=(max(float(solution[0]), 0.0), max(float(solution[1]), 0.0)),
        covariance=(
            (float(covariance[0, 0]), float(covariance[0, 1])),
            (float(covariance[1, 0]), float(covariance[1, 1])),
        ),
        known=all(g is not None for g in given),
        others=others,
    )


def _drag_gain(vehicle: Vehicle, v: Array) -> Array:
    return 0.5 * AIR_DENSITY * v**2 / vehicle.weight
