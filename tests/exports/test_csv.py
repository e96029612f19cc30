import csv
import io
import re
from pathlib import Path

import pandas as pd
import pytest

from calib.exports.build import build
from calib.exports.plain import TEXTS, write_csv
from tests.exports.conftest import bits

PAGE = Path(__file__).parents[2] / "calib" / "manual" / "tables.md"
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


def test_no_text_can_be_taken_for_a_number(stored):
    """Readers that guess types from the first rows would fail at a later one."""
    body = [line for line in write_csv(build(stored)).decode().splitlines() if line[0] != "#"]
    for row in csv.DictReader(body):
        for name in TEXTS:
            assert re.fullmatch(r"[-+0-9.eE]*[0-9][-+0-9.eE]*", row[name]) is None
        assert row["unit"]


@pytest.mark.parametrize(
    ("module", "line"),
    [
        ("pandas", 'pandas.read_csv("car.csv", comment="#")'),
        ("polars", 'polars.read_csv("car.csv", comment_prefix="#")'),
    ],
)
def test_the_line_of_the_manual_reads_it(stored, tmp_path, monkeypatch, module, line):
    library = pytest.importorskip(module)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "car.csv").write_bytes(write_csv(build(stored)))
    assert f"`{line}`" in PAGE.read_text()
    frame = eval(line, {module: library})
    units = dict(zip(frame["label"], frame["unit"], strict=True))
    assert (units["sedan_f1"], units["sedan_mass"]) == ("-", "kg")
    values = dict(zip(frame["label"], frame["value"], strict=True))
    assert values["sedan_mass"] == 1744.0
