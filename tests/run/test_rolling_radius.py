from dataclasses import replace

import numpy as np
import pytest

from calib.logs.read import read_log
from calib.run.driving_record import driving_record, rolling_radius
from tests.support.reference_car import IDEAL, SEDAN, stop, without


def test_it_is_that_of_the_plant():
    # Table I: 0.322 m on both axles; the plant rolls without resistance
    log = stop(IDEAL, duration=3.0)
    assert rolling_radius(log, driving_record(log)) == pytest.approx(0.322, rel=1e-4)


def test_another_size_is_found_from_the_speeds():
    log = stop(IDEAL, duration=3.0)
    larger = replace(log, channels=log.channels | {"v": 1.1 * log["v"]})
    assert rolling_radius(larger, driving_record(larger)) == pytest.approx(0.3542, rel=1e-4)


def test_without_v_or_without_rolling_it_is_not_known():
    log = read_log(SEDAN / "basalt_wet_pads.csv")
    bare = without(log, "v")
    assert rolling_radius(bare, driving_record(bare)) is None
    held = replace(log, channels=log.channels | {"p_mc": np.full(log.time.size, 2e6)})
    assert rolling_radius(held, driving_record(held)) is None
