"""Rolling resistance: a moment that slows every wheel in proportion to its load."""

from calib.car.effects.effect import Array, Card, Effect, Parameter, Parameters
from calib.car.history import Motion
from calib.car.vehicle import Vehicle

SPEED = 20.0
"""Speed [m/s] at which the coefficient is the whole resistance."""


def axle_moment(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> tuple[Array, Array]:
    """M = c_rr (1 + g ((v/20 m/s)^2 - 1)) F_z R [N m per axle]; no dependence on temperature.

    ``rolling_growth`` is 0 where it is not given.
    """
    grown = 1.0 + parameters.get("rolling_growth", 0.0) * ((motion.v / SPEED) ** 2 - 1.0)
    c_rr = parameters["coefficient"] * grown
    return (
        c_rr * motion.load_f * vehicle.front.rolling_radius,
        c_rr * motion.load_r * vehicle.rear.rolling_radius,
    )


EFFECT = Effect(
    card=Card(
        name="rolling_resistance",
        cause="hysteresis of the rolling tyre",
        equation=(
            "M = c_rr (1 + g ((v/20 m/s)^2 - 1)) F_z R, on each wheel; no effect at coefficient = 0"
        ),
        source="Gillespie, Fundamentals of Vehicle Dynamics, ch. 4; SAE J2452",
        looks_like="a deceleration without brake pressure that hardly depends on speed",
        parameters=(
            Parameter("coefficient", "1", 0.0, 0.05, 0.011, 0.005),
            Parameter("rolling_growth", "1", -0.2, 0.5, 0.1, 0.1, default=0.0),
        ),
    ),
    axle_moment=axle_moment,
)
