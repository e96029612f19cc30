"""A v that makes wheels of no car: an offset where a_x agrees with one, else another unit."""

from dataclasses import replace

import pytest

from calib.plausibility.rules import FIT, refusals
from calib.run.run import Run
from tests.support.made_runs import changed
from tests.support.plant import WHEELS
from tests.support.reference_car import REAL, noisy, ramp, stop

RAMP = noisy(ramp(REAL), 3)


def codes(log):
    return [one.code for one in refusals(Run(log), FIT)]


@pytest.mark.parametrize("offset", [59.6, -30.0])
def test_an_offset_of_the_wheel_speeds_is_named_with_its_size(offset):
    log = changed(RAMP, **{f"omega_{w}": RAMP[f"omega_{w}"] + offset for w in WHEELS})
    first = refusals(Run(log), FIT)[0]
    assert first.code == "wheel_offset"
    assert first.measured == pytest.approx(offset, rel=0.1)


@pytest.mark.parametrize("factor", [1.609, 3.6, 1.0 / 3.6])
def test_another_unit_of_v_is_one(factor):
    assert codes(changed(RAMP, v=factor * RAMP["v"]))[0] in (
        "v_unit",
        "v_unit_by_a_x",
        "v_beyond_cars",
    )


@pytest.mark.parametrize("log", [RAMP, replace(stop(REAL), truth={})])
def test_a_log_with_its_own_v_has_neither(log):
    assert not {"wheel_offset", "v_unit", "v_unit_by_a_x"} & set(codes(log))
