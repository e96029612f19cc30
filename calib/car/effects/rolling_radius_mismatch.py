"""Rolling radius mismatch: the radius of the rear tyres differs from that of the file."""

from calib.car.effects.effect import Card, Effect, Parameter, Parameters


def radius(parameters: Parameters) -> tuple[float, float]:
    """Factors 1 and 1 + m [1] on the rolling radii, front and rear.

    The front radius is taken as right: a common error of both is an error of the speed scale.
    """
    return 1.0, 1.0 + parameters["radius_mismatch"]


EFFECT = Effect(
    card=Card(
        name="rolling_radius_mismatch",
        cause="tread wear or inflation that differs between the axles",
        equation="R_r (1 + m); no effect at radius_mismatch = 0",
        source="Pacejka, Tyre and Vehicle Dynamics, ch. 1 (effective rolling radius)",
        looks_like="a constant factor on the rear wheel speeds, braked or not",
        parameters=(Parameter("radius_mismatch", "1", -0.03, 0.03, 0.003, 0.003),),
    ),
    radius=radius,
)
