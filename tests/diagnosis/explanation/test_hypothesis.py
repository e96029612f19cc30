"""What a hypothesis pays before the logs are read."""

import math

from calib.diagnosis.explanation.hypothesis import TURNING, Hypothesis


def test_a_ripple_pays_for_the_angle_that_was_taken_from_every_run():
    """Closed form: of noise alone, an amplitude with the best angle of each of n runs gains n pi/4.

    The length of a plane vector of unit noise is Rayleigh's, with the mean sqrt(pi/2).
    """
    for name in TURNING:
        paid = Hypothesis((name,)).price(40) - Hypothesis(("road_grade",)).price(40)
        assert paid > 40 * math.pi / 4.0
