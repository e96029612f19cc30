"""A table that a person corrected: what moves, what does not, and what stays in the record."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from calib.base.errors import RevisionError
from calib.store.derive import Moved, derive
from calib.store.record_file import from_content
from calib.store.store import Store
from calib.table.by_hand import SetByHand
from calib.table.invariants import violations
from calib.table.pad_levels import pad_levels
from calib.table.table import BY_HAND, TableReference
from tests.support.cars_of_a_line import car_table, version
from tests.support.tables import VEHICLE

PARENT = version(car_table(1), 3)
WHY = "seen on the bench"

# the load split at z = 0.15, in row 10 of the table, by (6) and (7) from the wheelbase
REAR = (1.1556 - 0.15 * 0.615) / 2.805
FRONT = 1.0 - REAR


def curves_of(table):
    return [*vars(table.difference).items(), *vars(table.paper).items()]


@pytest.mark.parametrize(
    ("key", "value", "D"),
    [("D", 0.08, 0.08), ("f1", 0.03, 0.03 / REAR), ("f2", -0.05, 0.05 / FRONT)],
)
def test_one_value_of_a_row_moves_all_three_and_their_bands(key, value, D):
    made = derive(PARENT, [f"{key}[1.0025]={value}"], WHY)
    d, p, old = made.table.difference, made.table.paper, PARENT.table
    assert (d.D[10], p.f1[10], p.f2[10]) == pytest.approx((D, D * REAR, -D * FRONT), rel=1e-12)
    assert {"D": d.D, "f1": p.f1, "f2": p.f2}[key][10] == value
    for new, before, name in ((d, old.difference, "D"), (p, old.paper, "f1"), (p, old.paper, "f2")):
        first = "" if name == "D" else f"{name}_"
        for end in ("lower", "upper"):
            half = getattr(new, first + end)[10] - getattr(new, name)[10]
            half_before = getattr(before, first + end)[10] - getattr(before, name)[10]
            assert half == pytest.approx(half_before, abs=1e-15)
    assert d.flag[10] == p.flag[10] == BY_HAND
    assert {m.key for m in made.moved} == {f"{n}[1.0025]" for n in ("D", "f1", "f2")} - {
        f"{key}[1.0025]"
    }
    assert violations(made.table) == ()


def test_the_other_rows_keep_every_bit():
    made = derive(PARENT, ["D[1.0025]=0.08"], WHY)
    for (name, new), (_, old) in zip(curves_of(made.table), curves_of(PARENT.table), strict=True):
        same = np.arange(21) != 10
        np.testing.assert_array_equal(new[same], old[same], err_msg=name)
    assert made.table.posterior == PARENT.table.posterior
    assert made.table.calibration == PARENT.table.calibration


@given(st.floats(0.06, 0.95), st.floats(0.06, 0.95))
def test_pads_move_level_and_ratio_and_no_curve(front, rear):
    known = PARENT.table.calibration
    # a value that is set already is refused
    assume(front != known.pad_friction_f.value and rear != known.pad_friction_r.value)
    made = derive(PARENT, [f"pad_friction_f={front!r}", f"pad_friction_r={rear!r}"], WHY)
    cal, old = made.table.calibration, PARENT.table.calibration
    assert (cal.pad_friction_f.value, cal.pad_friction_r.value) == (front, rear)
    # both pads of the file are 0.38
    assert cal.pad_scale.value == pytest.approx(math.sqrt(front * rear) / 0.38)
    assert cal.pad_log_ratio.value == pytest.approx(math.log(front / rear), abs=1e-12)
    assert pad_levels(VEHICLE, cal).ratio == pytest.approx(math.log(front / rear), abs=1e-12)
    for new, before in ((cal.pad_friction_f, old.pad_friction_f), (cal.pad_scale, old.pad_scale)):
        assert new.sigma / new.value == pytest.approx(before.sigma / before.value)
    for (_, new), (_, before) in zip(curves_of(made.table), curves_of(PARENT.table), strict=True):
        np.testing.assert_array_equal(new, before)
    assert {m.key for m in made.moved} == {"pad_scale", "pad_log_ratio"}
    assert violations(made.table) == ()


def test_the_ratio_reaches_the_posterior_that_the_estimator_uses(fitted):
    made = derive(version(fitted, 1), ["pad_friction_f=0.42"], WHY).table
    rear = fitted.calibration.pad_friction_r.value
    assert made.posterior.value("log_pad_ratio") == pytest.approx(math.log(0.42 / rear), abs=1e-12)
    assert made.posterior.covariance == fitted.posterior.covariance


def test_the_record_says_who_set_what_and_why(store):
    kept = Store(store)
    parent = kept.save(PARENT.table)
    made = derive(parent, ["pad_friction_r=0.37", "D[1.0025]=0.08"], f"  {WHY} ", "A. Smith")
    stored = kept.save(made.table)
    assert stored.id == "sedan@2"
    table = kept.load("sedan@2").table
    assert table.by_hand == (
        SetByHand("pad_friction_r", 0.38, 0.37, WHY, "A. Smith"),
        SetByHand("D[1.0025]", pytest.approx(0.0675), 0.08, WHY, "A. Smith"),
    )
    assert table.provenance.parents == (TableReference("sedan@1", parent.digest),)
    assert table.provenance.logs == PARENT.table.provenance.logs
    assert str(table.by_hand[0]) == (
        "pad_friction_r set by hand to 0.37 from 0.38, by A. Smith: seen on the bench"
    )
    assert {"derived from sedan@1", *map(str, table.by_hand)} <= set(table.remarks)
    assert kept.load("sedan@1").digest == parent.digest
    assert all(verdict.sound for verdict in kept.verify())


def test_a_second_correction_keeps_the_first():
    first = derive(PARENT, ["D[1.0025]=0.08"], WHY).table
    second = derive(version(first, 4), ["pad_friction_f=0.4"], "again").table
    assert [one.key for one in second.by_hand] == ["D[1.0025]", "pad_friction_f"]
    assert second.difference.flag[10] == BY_HAND
    assert [p.id for p in second.provenance.parents] == ["sedan@4"]


def test_what_moved_is_told_with_its_old_value():
    made = derive(PARENT, ["D[1.0025]=0.08"], WHY)
    f1 = next(m for m in made.moved if m.key == "f1[1.0025]")
    assert f1 == Moved("f1[1.0025]", pytest.approx(0.0675 * REAR), pytest.approx(0.08 * REAR))


@pytest.mark.parametrize(
    ("written", "reason", "says"),
    [
        (["D[1.0025]=0.08"], " ", "no reason was given"),
        (["pad_friction_f=0.38"], WHY, "pad_friction_f is 0.38 already"),
        (["f1[1.0025]=0.9"], WHY, "D would be 2.37; expected a D of -1 to 1"),
    ],
)
def test_what_is_no_correction_is_refused(written, reason, says):
    with pytest.raises(RevisionError, match=says):
        derive(PARENT, written, reason)


def test_marked_cells_that_nobody_set_are_a_flaw():
    made = derive(PARENT, ["D[1.0025]=0.08"], WHY).table
    assert violations(replace(made, by_hand=())) == (
        "by_hand: cells are marked as set by hand, and nobody set them",
    )
    assert from_content(*made.content()).by_hand == made.by_hand
