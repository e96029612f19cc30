"""Maps: their axes, interpolation between cells, storage and comparison."""

from dataclasses import fields, replace

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from scipy.interpolate import RegularGridInterpolator

from calib.base.errors import NotFiniteError
from calib.store.store import Store
from calib.table.compare import diff, is_same_fit
from calib.table.invariants import require_finite
from calib.table.maps import PadMap, columns
from calib.table.table import COLUMNS
from tests.support.tables import B_SHIFT, B_SLIP, B_Z, A, from_content, made_map, made_table

PARTS = ("map", "level_map", "draws")


def test_rows_are_every_combination_and_a_grid_has_the_shape_of_the_axes():
    pad_map = made_map()
    assert pad_map.shape == (4, 5, 3)
    assert pad_map.axes["shift"].tolist() == [-0.004, 0.0, 0.003, 0.007, 0.02]
    assert pad_map.z.tolist() == sorted([0.1, 0.3, 0.45, 0.8] * 15)
    assert pad_map.grid("ratio")[2, 4, 1] == A + B_Z * 0.45 + B_SHIFT * 0.02 + B_SLIP * 0.5
    assert pad_map.bounded_columns == ("ratio", "change")


def test_a_map_is_read_linearly_along_each_axis_and_clamped():
    """The truth is an interpolator of SciPy on random numbers."""
    rng = np.random.default_rng(3)
    axes = [np.sort(rng.random(n)) for n in (4, 5, 3)]
    values = rng.normal(size=(4, 5, 3))
    names = [entry.name for entry in fields(PadMap)][3:]
    pad_map = PadMap.from_grids(axes, **dict.fromkeys(names, values))
    places = [np.linspace(-0.2, 1.2, 9), np.linspace(-0.1, 1.1, 7), np.linspace(0.0, 1.0, 5)]
    clamped = [np.clip(x, a[0], a[-1]) for x, a in zip(places, axes, strict=True)]
    points = np.meshgrid(*clamped, indexing="ij")
    true = RegularGridInterpolator(axes, values)(np.stack(points, axis=-1))
    np.testing.assert_allclose(pad_map.on(places).grid("ratio"), true, atol=1e-12)


def test_maps_come_back_to_the_bit(tmp_path):
    table = made_table()
    assert from_content(*table.content()).digest == table.digest
    saved = Store(tmp_path).save(table)
    read = Store(tmp_path).load(saved.id).table
    assert read.digest == table.digest
    assert {p.stem for p in saved.path.glob("*.parquet")} == {*COLUMNS}
    for name in PARTS:
        frame = pd.read_parquet(saved.path / f"{name}.parquet")
        pd.testing.assert_frame_equal(frame, pd.DataFrame(columns(getattr(table, name))))
    assert read.map.shape == (4, 5, 3)
    assert read.draws.forms.shape == (40, 5)
    assert Store(tmp_path).save(table).version == 1


def test_the_draws_state_their_units(tmp_path):
    path = Store(tmp_path).save(made_table()).path
    schema = pq.read_schema(path / "draws.parquet")
    units = {field.name: field.metadata[b"unit"].decode() for field in schema}
    other = {name: unit for name, unit in units.items() if unit != "1"}
    assert other == {"v_late": "s", "cg_to_front_axle": "m", "cg_height": "m", "weight": "N"}


@pytest.mark.parametrize("part", PARTS)
def test_every_number_of_a_map_must_be_finite(part):
    table = made_table()
    part_of_table = getattr(table, part)
    for name in vars(part_of_table):
        cells = np.array(getattr(part_of_table, name))
        cells[1] = np.nan
        bad = replace(part_of_table, **{name: cells})
        with pytest.raises(NotFiniteError, match=f"{part}.{name}"):
            require_finite(replace(table, **{part: bad}))


def test_two_maps_differ_by_their_closed_form():
    """A difference of 0.04 z is largest at the end of the common part of the axes."""
    table, other = made_table(), made_map((0.2, 0.6), (-0.002, 0.01), (-2.0, 0.0, 1.0))
    moved = ("ratio", "ratio_lower", "ratio_upper")
    tilt = {name: getattr(other, name) + 0.04 * other.z for name in moved}
    difference = diff(table, replace(table, map=replace(other, **tilt)))
    gap = next(entry for entry in difference.curves if entry.curve == "map ratio")
    assert (gap.start, gap.end, gap.at) == (0.2, 0.6, 0.6)
    assert gap.largest == pytest.approx(0.04 * 0.6, abs=1e-12)
    assert gap.in_bands == pytest.approx(0.04 * 0.6 / np.hypot(0.15, 0.15), rel=1e-9)
    assert not difference.identical


def test_a_table_differs_from_one_with_other_draws():
    table = made_table()
    assert diff(table, made_table()).identical
    stiff = replace(table.draws, compliance_f=1.1 * table.draws.compliance_f)
    difference = diff(table, replace(table, draws=stiff))
    assert not difference.identical
    assert difference.verdict == "equal within bands"


def test_two_fits_are_the_same_only_if_their_maps_are():
    table = made_table()
    near, far = (
        replace(made_table(), map=replace(made_map(), ratio=made_map().ratio * (1.0 + change)))
        for change in (1e-6, 1e-4)
    )
    assert is_same_fit(table, near)
    assert not is_same_fit(table, far)
