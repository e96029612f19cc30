import pytest

from calib.estimation.limits import Limit
from calib.line.gauge.tolerance import tolerances


def test_a_tolerance_is_the_width_of_the_range_of_a_metric():
    limits = (Limit("grr", None, 0.3), Limit("pad_scale", 0.8, 1.2), Limit("f1_ndc", 5.0, None))
    assert tolerances(limits, ("pad_scale", "f1")) == {"pad_scale": pytest.approx(0.4)}
