"""Every metric has a name for people, and a value is rounded to its relevant digits."""

import pytest

from calib.base.plain import METRICS, NBSP, metric_of
from calib.estimation.metrics import METRICS as OF_STOPS
from calib.line.fleet.rows import Command, columns_of
from calib.line.station.metrics import METRICS as OF_CAR


def test_every_metric_has_a_plain_name():
    of_fleet = {c.name for x in Command for c in columns_of(x) if c.kind is float}
    assert {*OF_CAR, *OF_STOPS, *of_fleet} <= {*METRICS}
    assert not {*METRICS} & {shown.name for shown in METRICS.values()}


@pytest.mark.parametrize(
    ("key", "value", "text"),
    [
        ("valid_share", 0.95164, "95.2 %"),
        ("ramp_eta_zero", -0.001176, "-0.12 %"),
        ("side_difference_f", -0.0001, "0.0 %"),
        ("pad_friction_f", 0.38123, "0.381"),
        ("pressure_max", 41.23e5, "41.2 bar"),
        ("valid_share", None, "not known"),
    ],
)
def test_a_value_is_shown_in_the_unit_that_people_read(key, value, text):
    assert metric_of(key).with_unit(value).replace(NBSP, " ") == text
