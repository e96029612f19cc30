"""A load put into the equations by hand comes out again."""

import math

import pytest

from calib.plausibility.load import Load, is_load, load_behind

Z, HEIGHT = 0.4, 0.2  # deceleration; centre of gravity over the wheelbase
BRAKES, REST = 0.72, 0.59  # front shares of the brake force and of the weight


def seen(share, front):
    """ln of level and of the pads' ratio that an estimator finds which knows nothing of the load.

    Weight 1, tyres with slip in proportion to force over load. It knows the sum of forces and the
    difference of the axles' forces over their loads.
    """
    u_0, u = REST + Z * HEIGHT, REST + share * front + (1.0 + share) * Z * HEIGHT
    total = (1.0 + share) * Z
    true_f, true_r = BRAKES * total, (1.0 - BRAKES) * total
    difference = true_f / u - true_r / (1.0 + share - u)
    found_f = (difference + Z / (1.0 - u_0)) / (1.0 / u_0 + 1.0 / (1.0 - u_0))
    change_f, change_r = found_f / true_f, (Z - found_f) / true_r
    return math.log(BRAKES * change_f + (1.0 - BRAKES) * change_r), math.log(change_f / change_r)


@pytest.mark.parametrize(("share", "front"), [(-0.15, 0.3), (0.05, -0.1), (0.2, 0.6)])
def test_a_load_comes_out_again(share, front):
    load = load_behind(*seen(share, front), BRAKES, REST + Z * HEIGHT, Z * HEIGHT)
    assert load.share == pytest.approx(share, rel=1e-9)
    assert load.front == pytest.approx(front, abs=1e-9)


def test_an_interval_that_crosses_the_seats_holds_a_load():
    assert is_load(Load(0.1, -2.0), Load(0.1, 2.0))
    assert not is_load(Load(0.1, 0.8), Load(0.1, 2.0))
    assert is_load(None, Load(0.1, 0.5))
    assert not is_load(None, None)
    assert load_behind(0.0, 0.1, BRAKES, REST, 0.0) is None


def test_pads_of_one_axle_are_no_load():
    """Weak front pads would be a load in front of the car, weak rear pads one far behind it."""
    for change_f, change_r, side in ((0.8, 1.0, 1.0), (1.0, 0.6, -1.0)):
        level = math.log(BRAKES * change_f + (1.0 - BRAKES) * change_r)
        apart = math.log(change_f / change_r)
        load = load_behind(level, apart, BRAKES, REST + Z * HEIGHT, Z * HEIGHT)
        assert side * (load.front - 0.25) > 0.5
        assert not is_load(load)
