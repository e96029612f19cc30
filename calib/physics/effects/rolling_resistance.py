"""Rolling resistance: a moment that slows every wheel in proportion to its load."""

from calib.physics.effects.effect import Array, Card, Effect, Parameter, Parameters
from calib.physics.history import Motion
from calib.physics.vehicle import Vehicle

SPEED = 20.0
"""Speed at which the coefficient is told [m/s]."""


def axle_moment(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> tuple[Array, Array]:
    """M = c_rr (1 + g (v - 20 m/s)) F_z R [N m per axle]; no dependence on temperature.

    A tyre resists more at speed; ``rolling_growth`` g is 0 where it is not given, as in older
    files. Valid up to some 45 m/s: standing waves of the tread add more beyond.
    """
    growth = parameters.get("rolling_growth", 0.0)
    c_rr = parameters["coefficient"] * (1.0 + growth * (motion.v - SPEED))
    return (
        c_rr * motion.load_f * vehicle.front.rolling_radius,
        c_rr * motion.load_r * vehicle.rear.rolling_radius,
    )


EFFECT = Effect(
    card=Card(
        name="rolling_resistance",
        cause="hysteresis of the rolling tyre",
        equation=(
            "M = c_rr (1 + g (v - 20 m/s)) F_z R, on each wheel; no effect at coefficient = 0"
        ),
        source="Gillespie, Fundamentals of Vehicle Dynamics, ch. 4; SAE J2452",
        looks_like="a nearly constant deceleration without brake pressure",
        parameters=(
            Parameter("coefficient", "1", 0.0, 0.05, 0.011, 0.005),
            Parameter("rolling_growth", "s/m", -0.01, 0.03, 0.004, 0.004, default=0.0),
        ),
    ),
    axle_moment=axle_moment,
)
