"""Rolling resistance: a moment that slows every wheel in proportion to its load."""

from calib.physics.effects.effect import Array, Card, Effect, Parameter, Parameters
from calib.physics.history import Motion
from calib.physics.vehicle import Vehicle


def axle_moment(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> tuple[Array, Array]:
    """M = c_rr F_z R [N m per axle]; no dependence on speed or temperature."""
    c_rr = parameters["coefficient"]
    return (
        c_rr * motion.load_f * vehicle.front.rolling_radius,
        c_rr * motion.load_r * vehicle.rear.rolling_radius,
    )


EFFECT = Effect(
    card=Card(
        name="rolling_resistance",
        cause="hysteresis of the rolling tyre",
        equation="M = c_rr F_z R, on each wheel; no effect at coefficient = 0",
        source="Gillespie, Fundamentals of Vehicle Dynamics, ch. 4; SAE J2452",
        looks_like="a constant deceleration without brake pressure, independent of speed",
        parameters=(Parameter("coefficient", "1", 0.0, 0.05, 0.011, 0.005),),
    ),
    axle_moment=axle_moment,
)
