"""Tables as an ECU reads them: breakpoints of maps, rounding, and the errors of both."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from calib.base.errors import ExchangeError
from calib.exports.build import build
from calib.table.breakpoints import place_weighted
from calib.table.exported import Precision, as_exported, written_map
from calib.table.maps import PadMap
from tests.support.tables import B_SHIFT, B_SLIP, B_Z, A, made_map, made_table, stored_as

WIDTHS = [{}, {"single": True}, {"bits": 8}, {"bits": 16}, {"bits": 32}]


def curved():
    """A map of the size and shape of a fitted one: a saddle that levels off on both sides."""
    axes = np.linspace(0.06, 0.85, 8), np.linspace(-0.004, 0.05, 19), np.linspace(-1.5, 1.5, 4)
    z, shift, slip = np.meshgrid(*axes, indexing="ij")
    ratio = 0.6 * np.tanh((shift - 0.012 + 0.02 * z) / 0.015) + 0.04 * slip
    half = 0.12 + 0.3 * np.exp(-(((shift - 0.03) / 0.02) ** 2)) * (1.0 + z)
    ends = {"_lower": ratio - half, "": ratio, "_upper": ratio + 1.3 * half}
    columns = {f"{name}{end}": x for name in ("ratio", "change") for end, x in ends.items()}
    slip_columns = {"log_slip": -3.0 - z + 9.0 * shift, "log_slip_sigma": 0.1 + 0.5 * z}
    return PadMap.from_grids(axes, **columns, **slip_columns, share=np.ones_like(z), prior=half)


def test_breakpoints_are_those_where_the_map_bends():
    """A map that is linear between few values of z and shift keeps these values, without error."""
    values = np.outer([1.0, 0.2, 0.5], [0.3, -0.2, 0.4, 0.5])[..., None]
    bent_map = PadMap.from_grids(
        [np.array([0.1, 0.4, 0.8]), np.array([-0.004, 0.003, 0.008, 0.02]), np.zeros(1)],
        **dict.fromkeys(made_map().names, values) | {"share": np.ones_like(values)},
    )
    fine = bent_map.on([np.linspace(0.1, 0.8, 15), np.linspace(-0.004, 0.02, 25), np.zeros(1)])
    written = written_map(fine, Precision(points=4), "map")
    assert written.axes["z"].values[[0, -1]].tolist() == [0.1, 0.8]
    assert {0.4} <= set(written.axes["z"].values.round(12))
    assert written.axes["shift"].values == pytest.approx([-0.004, 0.003, 0.008, 0.02])
    assert written.misfit["z"].worst < 1e-12


def test_breakpoints_stand_where_stops_are():
    """A part of the map that no stop reaches takes no breakpoints from the part where stops are."""
    z, shift = np.array([0.1, 0.4]), np.linspace(-0.3, 0.3, 25)
    usual = np.exp(-0.5 * (shift / 0.05) ** 2)
    values = np.tanh(shift / 0.05) + np.where(np.abs(shift) > 0.2, np.cos(300.0 * shift), 0.0)
    grids = {name: np.tile(values, (2, 1))[..., None] for name in made_map().names}
    grids |= {"ratio_lower": grids["ratio"] - 0.1, "ratio_upper": grids["ratio"] + 0.1}
    grids["share"] = np.tile(usual, (2, 1))[..., None]
    whole = PadMap.from_grids([z, shift, np.zeros(1)], **grids)
    written = written_map(whole, Precision(points=9), "map")
    read = np.interp(shift, written.axes["shift"].values, written.columns["ratio"].values[:9])
    assert np.max(np.abs(read - values)[usual > 0.1]) < 0.06


@pytest.mark.parametrize("points", [2, 5, 9])
def test_no_other_weighted_placement_is_better(points):
    rng = np.random.default_rng(points)
    x, curves = np.sort(rng.random(11)), rng.normal(size=(6, 11)).cumsum(axis=1)
    weights = rng.random((6, 11))

    def error(rows):
        gaps = [np.interp(x, x[rows], y[rows]) - y for y in curves]
        return np.sum(weights * np.array(gaps) ** 2)

    placements = [[0, *c, 10] for k in range(points - 1) for c in combinations(range(1, 10), k)]
    kept_rows = place_weighted(x, curves, weights, points)
    assert error(kept_rows) == pytest.approx(min(map(error, placements)), abs=1e-12)


@pytest.mark.parametrize("how", WIDTHS, ids=str)
def test_a_plane_costs_no_more_than_its_rounding(how):
    """Cells are read at the rounded axes, so a coarse axis adds no error within its ends."""
    plane = made_map(z=np.linspace(0.05, 0.85, 9), shift=np.linspace(-0.004, 0.02, 9))
    exported = as_exported(replace(made_table(), map=plane), Precision(points=5, **how)).map
    inside = np.ones(exported.z.size, dtype=bool)
    for name, axis in plane.axes.items():
        x = getattr(exported, name)
        inside &= (axis[0] <= x) & (x <= axis[-1])
    true = plane.on([*exported.axes.values()])
    bits = how.get("bits", 24 if how else 53)
    assert np.abs(exported.ratio_upper - true.ratio_upper)[inside].max() <= 2.0**-bits
    plane_values = A + B_Z * exported.z + B_SHIFT * exported.shift + B_SLIP * exported.slip
    assert np.abs(exported.ratio - plane_values)[inside].max() <= 2.0**-bits


@pytest.mark.parametrize("how", WIDTHS, ids=str)
@pytest.mark.parametrize("points", [None, 7])
def test_every_format_has_the_numbers_of_the_exported_table(how, points):
    table = replace(made_table(), map=curved())
    t = as_exported(table, Precision(points, **how))
    objects = build(replace(stored_as("sedan@1"), table=table), points, **how).objects
    exported = {x.label: x.values if x.fixed is None else x.fixed.values for x in objects}
    for name, column in (
        ("eta", t.paper.eta), ("f1", t.paper.f1), ("f2", t.paper.f2), ("D", t.difference.D),
        ("slip", t.tyre.slip), ("g", t.tyre.force), ("ratio", t.map.ratio),
        ("prior", t.map.prior), ("change_0_upper", t.level_map.change_upper),
        ("level_lower", t.level_map.level_lower), ("shift", t.map.axes["shift"]),
        ("z_level", t.level_map.z), ("slip_apart", t.map.axes["slip"]),
        ("log_slip", t.map.grid("log_slip")[..., 0].ravel()),
        ("log_slip_sigma", t.map.grid("log_slip_sigma")[..., -1].ravel()),
    ):  # fmt: skip
        assert exported[f"sedan_{name}"].tolist() == column.tolist(), name
    assert t.paper.f1_lower.size == t.paper.f1.size
    assert t.vehicle == table.vehicle


def test_600_bytes_hold_the_map():
    """The map has 6 by 6 by 4 cells in 8 bits: ratio, bounds, log_slip, sigma, and the axes."""
    table = replace(made_table(), map=curved())
    columns = ("z", "shift", "slip_apart", "ratio", "ratio_lower", "ratio_upper", "log_slip")
    labels = {f"sedan_{name}" for name in (*columns, "log_slip_sigma")}
    objects = build(replace(stored_as("sedan@1"), table=table), 6, bits=8).objects
    integers = [x.fixed for x in objects if x.label in labels]
    assert len(integers) == len(labels)
    assert sum(x.raw.size * x.bits // 8 for x in integers) <= 600
    table = as_exported(table, Precision(points=6, bits=8))
    draw = np.random.default_rng(1)
    places = [np.sort(draw.uniform(*ends, 30)) for ends in ((0.1, 0.8), (0.0, 0.04), (-1.0, 1.0))]
    gap = table.map.on(places).ratio - curved().on(places).ratio
    assert np.sqrt(np.mean(gap**2)) < 0.015


def test_an_axis_that_no_longer_increases_is_refused():
    close = made_map(shift=(-0.004, 0.0, 1e-7, 0.02))
    for how in (Precision(bits=8), Precision(bits=12), Precision(bits=16)):
        with pytest.raises(ExchangeError):
            as_exported(replace(made_table(), map=close), how)
    near = made_map(z=(0.1, 0.1 + 1e-9, 0.8))
    with pytest.raises(ExchangeError, match="map, z"):
        as_exported(replace(made_table(), map=near), Precision(single=True))
