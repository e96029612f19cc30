import io

import pandas as pd
import pytest

from calib.exports.build import build
from calib.exports.csv import write_csv
from tests.exports.conftest import bits

NUMBERS = ("x", "value", "lower", "upper", "count", "flag")


def read(content):
    # As text first: pandas 2 reads some numbers one bit off, and pandas 3 has no option for it.
    text = pd.read_csv(io.BytesIO(content), comment="#", dtype=dict.fromkeys(NUMBERS, str))
    return text.astype(dict.fromkeys(NUMBERS, float))


@pytest.mark.smoke
@pytest.mark.parametrize("points", [None, 16])
def test_pandas_sees_the_table_to_the_last_bit(real, truth, points):
    data = build(real, points)
    frame = read(write_csv(data))
    for name in ("f1", "f2", "D", "g"):
        part = frame[frame["label"] == f"{data.prefix}_{name}"]
        assert bits(part["x"], part["value"]) == truth(real).at(set(part["x"]))[name]
    assert len(part) == (points or len(real.table.tyre.slip))


def test_bands_counts_and_flags_come_along(stored):
    frame, paper = read(write_csv(build(stored))), stored.table.paper
    part = frame[frame["label"] == "sedan_f2"]
    for column, values in (
        ("lower", paper.f2_lower),
        ("upper", paper.f2_upper),
        ("count", paper.count),
        ("flag", paper.flag),
    ):
        assert part[column].tolist() == values.tolist()


def test_a_scalar_has_no_axis(stored):
    frame = read(write_csv(build(stored))).set_index("label")
    row = frame.loc["sedan_mass"]
    assert (row["value"], row["unit"]) == (1744.0, "kg")
    assert pd.isna(row["x"])
    assert pd.isna(row["axis"])
    scale = frame.loc["sedan_mu_f"]
    assert scale["upper"] - scale["value"] == pytest.approx(1.96 * 0.01)


def test_the_head_says_what_it_is(stored):
    text = write_csv(build(stored)).decode()
    for part in ("# table: sedan@1\n", f"# digest: {stored.digest}\n", "# ends: outside an axis"):
        assert part in text
