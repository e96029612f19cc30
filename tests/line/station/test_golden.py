"""The distance of two tables that are a closed form: D = C (eta - 1)."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.line.station.golden import distance, ratios_to
from tests.support.tables import made_table


def test_a_table_lies_on_itself():
    found = distance(made_table(), made_table())
    assert (found.relative, found.bands) == (0.0, 0.0)


@pytest.mark.parametrize("stiffness", [20.0, 30.0])
def test_the_distance_is_that_of_the_stiffnesses(stiffness):
    found = distance(made_table(stiffness), made_table(27.0))
    assert found.relative == pytest.approx(abs(stiffness / 27.0 - 1.0))
    # both bands are 2 (eta - 1) to either side
    assert found.bands == pytest.approx(abs(stiffness - 27.0) / (2.0 * 2.0**0.5))
    assert found.at == pytest.approx(1.005)


def test_the_bands_are_those_where_the_tables_are_farthest_apart():
    # D is 27 (eta - 1) and 30 (eta - 1); half widths of 0.03 at the end, and next to nothing before
    def with_width(stiffness, half):
        table = made_table(stiffness)
        d = table.difference
        return replace(table, difference=replace(d, lower=d.D - half, upper=d.D + half))

    half = np.full(21, 1e-6)
    half[-1] = 0.03
    found = distance(with_width(30.0, half), with_width(27.0, half))
    assert found.at == pytest.approx(1.005)
    assert found.bands == pytest.approx(3.0 * 0.005 / (0.03 * 2.0**0.5))
    bare = [with_width(stiffness, np.zeros(21)) for stiffness in (30.0, 27.0)]
    assert distance(*bare).bands == np.inf
    assert distance(bare[0], bare[0]).bands == 0.0


def test_a_short_table_has_no_distance():
    golden = made_table()
    d = golden.difference
    short = replace(d, **{name: getattr(d, name)[:8] for name in vars(d)})
    assert distance(replace(golden, difference=short), golden) is None
    assert distance(golden, replace(golden, difference=short)) is not None


def test_pads_and_tyres_are_compared_where_D_is_the_same():
    golden = made_table()
    cal, posterior = golden.calibration, golden.posterior
    front = replace(cal.pad_friction_f, value=0.8 * cal.pad_friction_f.value)
    at = posterior.names.index("log_compliance")
    softer = tuple(m + math.log(1.25) * (i == at) for i, m in enumerate(posterior.mean))
    table = replace(
        golden,
        calibration=replace(cal, pad_friction_f=front),
        posterior=replace(posterior, mean=softer),
    )
    found = ratios_to(table, golden)
    assert distance(table, golden).relative == 0.0
    assert found.front == pytest.approx(0.8)
    assert found.rear == pytest.approx(1.0)
    assert found.stiffness == pytest.approx(1.0 / 1.25)
