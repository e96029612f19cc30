"""Mass error: the mass of the car differs from that of its file."""

from calib.car.effects.effect import Card, Effect, Parameter, Parameters


def mass(parameters: Parameters) -> float:
    """Factor 1 + e [1] on the mass; the centre of gravity stays where it is."""
    return 1.0 + parameters["mass_error"]


EFFECT = Effect(
    card=Card(
        name="mass_error",
        cause="passengers, load or fuel other than in the vehicle file",
        equation="M_v (1 + e), in (5) to (7); no effect at mass_error = 0",
        source="Newton's second law; (5) to (7) of the paper",
        looks_like="all brakes weaker by one factor, like a lower pad level; drag has less effect",
        parameters=(Parameter("mass_error", "1", -0.3, 0.3, 0.05, 0.04),),
    ),
    mass=mass,
)
