"""Files with effects of the user's own."""

from calib.help.samples import sample_logs

EXAMPLE = sample_logs() / "own_effect" / "air_brake_flap.py"

RETARDER = """import numpy as np
from calib.car.effects.effect import Card, Effect, Parameter

def axle_moment(vehicle, parameters, motion):
    {body}

EFFECT = Effect(
    Card(name="rear_retarder", cause="a coil", equation="T", source="-", looks_like="-",
         parameters=(Parameter("torque", "N*m", 0.0, 2000.0, 900.0, 400.0),)),
    axle_moment=axle_moment,
)
"""

MOMENT = "return np.zeros_like(motion.v), 0.5 * parameters['torque'] * motion.v / (1.0 + motion.v)"


def retarder(body: str = MOMENT) -> str:
    """A file with an effect of one parameter on the rear axle, by the text of its function."""
    return RETARDER.format(body=body)
