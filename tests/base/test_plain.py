"""Every metric has a name for people, and a value is rounded to its relevant digits."""

import pytest

from calib.base.plain import METRICS, NBSP, metric_of
from calib.estimation.metrics import METRICS as STOP_METRICS
from calib.line.fleet.rows import Command, columns_of
from calib.line.station.metrics import METRICS as CAR_METRICS


def test_every_metric_has_a_plain_name():
    columns = [column for command in Command for column in columns_of(command)]
    fleet_metrics = {column.name for column in columns if column.kind is float}
    assert {*CAR_METRICS, *STOP_METRICS, *fleet_metrics} <= {*METRICS}
    assert not {*METRICS} & {metric.name for metric in METRICS.values()}


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
