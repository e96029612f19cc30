"""The explicit list of effects. A new one is one file and one line here."""

from calib.effects import aerodynamic_drag, rolling_resistance
from calib.effects.effect import Array, Effect, Motion, Parameters
from calib.errors import ModelError
from calib.vehicle import Vehicle

CATALOGUE: dict[str, Effect] = {
    effect.card.name: effect
    for effect in (
        aerodynamic_drag.EFFECT,
        rolling_resistance.EFFECT,
    )
}


def effect_named(name: str) -> Effect:
    """Return the effect of that name. Raises ModelError naming the known ones."""
    if name not in CATALOGUE:
        raise ModelError(
            f"unknown effect {name!r}",
            expected=f"one of {', '.join(CATALOGUE)}",
            do="see calib/effects",
        )
    return CATALOGUE[name]


def total_body_force(vehicle: Vehicle, effects: dict[str, Parameters], motion: Motion) -> Array:
    """Sum of what slows the body directly [N]."""
    total = 0.0 * motion.v
    for name, parameters in effects.items():
        total = total + effect_named(name).body_force(vehicle, parameters, motion)
    return total


def total_axle_moment(
    vehicle: Vehicle, effects: dict[str, Parameters], motion: Motion
) -> tuple[Array, Array]:
    """Sum of what slows the wheels besides the brake [N m per axle], front and rear."""
    front, rear = 0.0 * motion.v, 0.0 * motion.v
    for name, parameters in effects.items():
        f, r = effect_named(name).axle_moment(vehicle, parameters, motion)
        front, rear = front + f, rear + r
    return front, rear
