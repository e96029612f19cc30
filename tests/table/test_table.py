import hashlib
import struct
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.digest import content_digest
from calib.car.effects.effects import Effects
from tests.support.tables import K, from_content, made_table

PARTS = ("difference", "paper", "tyre", "map", "level_map", "draws")
CURVES = PARTS[:3]


def test_content_and_back_is_the_same_table(table):
    again = from_content(*table.content())
    assert again.digest == table.digest
    for field in fields(table):
        ours, theirs = getattr(table, field.name), getattr(again, field.name)
        if field.name in PARTS:
            for column in vars(ours):
                np.testing.assert_array_equal(getattr(theirs, column), getattr(ours, column))
        else:
            assert theirs == ours


def test_empty_keys_are_left_out_of_a_record(table):
    record, _ = table.content()
    optional = {"own_effects", "empirical", "warnings", "spread"}
    assert not optional & set(record)
    assert not {"identity", "parents"} & set(record["provenance"])
    assert "motor_odds" not in record["vehicle"]
    assert "pad_friction_tolerance" not in {*record["vehicle"]["front"], *record["vehicle"]["rear"]}
    assert all(set(log) == {"name", "digest", "role"} for log in record["provenance"]["logs"])
    with_odds = replace(table, vehicle=replace(table.vehicle, motor_odds=0.0))
    assert from_content(*with_odds.content()).vehicle.motor_odds == 0.0
    rear = replace(table.vehicle.rear, pad_friction_tolerance=0.03)
    with_tolerance = replace(table, vehicle=replace(table.vehicle, rear=rear))
    assert from_content(*with_tolerance.content()).vehicle == with_tolerance.vehicle
    assert with_tolerance.digest != table.digest


def test_digest_is_sha256_of_the_canonical_content():
    by_hand = hashlib.sha256(
        b'{"a":[1,2.5],"b":"x"}'
        + b"\ncurve.p\n"
        + struct.pack("<2d", 1.0, -0.5)
        + b"\ncurve.q\n"
        + struct.pack("<2d", 0.0, 3.0)
    ).hexdigest()
    curves = {"curve": {"q": np.array([0.0, 3.0]), "p": np.array([1.0, -0.5])}}
    assert content_digest({"b": "x", "a": [1, 2.5]}, curves) == by_hand


@given(
    column=st.sampled_from([(c, f.name) for c in CURVES for f in fields(getattr(made_table(), c))]),
    row=st.integers(0, 20),
)
def test_one_bit_of_any_column_changes_the_digest(column, row):
    table = made_table()
    record, curves = table.content()
    changed = np.array(curves[column[0]][column[1]])
    changed[row] = np.nextafter(changed[row], np.inf)
    curves[column[0]][column[1]] = changed
    assert content_digest(record, curves) != table.digest


def test_any_part_of_the_record_changes_the_digest(table):
    for change in (
        {"remarks": ("other",)}, {"quality": {"rms": 0.0022}}, {"noise": {}}, {"name": "wagon"},
        {"effects": Effects()},
    ):  # fmt: skip
        assert replace(table, **change).digest != table.digest


def test_the_usable_range_ends_with_the_last_measured_row(table):
    # the last of 21 rows is extrapolated
    assert table.paper.usable == pytest.approx((0.0, K * 0.00475), rel=1e-12)
    assert table.paper.usable_eta == pytest.approx((1.0, 1.00475), rel=1e-12)
