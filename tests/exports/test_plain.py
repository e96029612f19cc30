"""JSON, CSV, Parquet and the CSV of INCA hold the table to the last bit."""

import csv
import io
import json
import re
from pathlib import Path

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from calib.exports.build import build
from calib.exports.plain import TEXTS, write_csv, write_inca_csv, write_json, write_parquet
from tests.exports.conftest import bits


@pytest.mark.parametrize("points", [None, 16])
def test_json_holds_the_table_to_the_last_bit(real, truth, points):
    data = build(real, points)
    document = json.loads(write_json(data, real))
    axes = {a["label"]: a for a in document["axes"]}
    for curve in document["curves"]:
        axis = axes[curve["axis"]]
        name = curve["label"].removeprefix(f"{data.prefix}_")
        assert bits(axis["values"], curve["values"]) == truth(real).at(set(axis["values"]))[name]
        assert len(axis["values"]) == (points or axis["rows"])


def test_it_says_what_it_is_and_what_the_table_rests_on(stored):
    document = json.loads(write_json(build(stored), stored))
    assert (document["table"], document["version"]) == ("sedan@1", 1)
    assert document["digest"] == stored.digest
    assert document["record"] == stored.table.content()[0]
    assert "clamped" in document["ends"]


PAGE = Path(__file__).parents[2] / "calib" / "manual" / "tables.md"
NUMBERS = ("x", "value", "lower", "upper", "count", "flag")


def read_csv(content):
    # As text first: pandas 2 reads some numbers one bit off, and pandas 3 has no option for it.
    text = pd.read_csv(io.BytesIO(content), comment="#", dtype=dict.fromkeys(NUMBERS, str))
    return text.astype(dict.fromkeys(NUMBERS, float))


@pytest.mark.smoke
@pytest.mark.parametrize("points", [None, 16])
def test_pandas_sees_the_table_to_the_last_bit(real, truth, points):
    data = build(real, points)
    frame = read_csv(write_csv(data))
    for name in ("f1", "f2", "D", "g"):
        part = frame[frame["label"] == f"{data.prefix}_{name}"]
        assert bits(part["x"], part["value"]) == truth(real).at(set(part["x"]))[name]
    assert len(part) == (points or len(real.table.tyre.slip))


def test_bands_counts_and_flags_come_along(stored):
    frame, paper = read_csv(write_csv(build(stored))), stored.table.paper
    part = frame[frame["label"] == "sedan_f2"]
    for column, values in (
        ("lower", paper.f2_lower),
        ("upper", paper.f2_upper),
        ("count", paper.count),
        ("flag", paper.flag),
    ):
        assert part[column].tolist() == values.tolist()


def test_a_scalar_has_no_axis(stored):
    frame = read_csv(write_csv(build(stored))).set_index("label")
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


def read_parquet(content):
    return pq.read_table(pa.BufferReader(content), use_threads=False)


@pytest.mark.parametrize("points", [None, 16])
def test_pyarrow_sees_the_table_to_the_last_bit(real, truth, points):
    data = build(real, points)
    columns = read_parquet(write_parquet(data)).to_pydict()
    for name in ("f1", "f2", "D", "g"):
        at = [i for i, label in enumerate(columns["label"]) if label == f"{data.prefix}_{name}"]
        x, y = ([columns[c][i] for i in at] for c in ("x", "value"))
        assert bits(x, y) == truth(real).at(set(x))[name]
    assert len(at) == (points or len(real.table.tyre.slip))


def test_facts_are_metadata_and_scalars_have_no_axis(stored):
    table = read_parquet(write_parquet(build(stored)))
    facts = {k.decode(): v.decode() for k, v in table.schema.metadata.items()}
    assert (facts["table"], facts["version"], facts["digest"]) == ("sedan@1", "1", stored.digest)
    assert "clamped" in facts["ends"]
    row = next(r for r in table.to_pylist() if r["label"] == "sedan_mass")
    assert (row["axis"], row["x"], row["value"], row["unit"]) == (None, None, 1744.0, "kg")


def blocks(content):
    """Rows of each object by its label, as the csv module splits them."""
    text = content.decode()
    found = {}
    for part in text.split("\r\n\r\n"):
        lines = [line for line in part.split("\r\n") if line and not line.startswith("*")]
        rows = list(csv.reader(lines, delimiter=";"))
        if rows and rows[0][0] == "" and len(rows[0]) == 2:
            found[rows[0][1]] = rows[1:]
    return found


@pytest.mark.parametrize("points", [None, 16])
def test_blocks_hold_the_table_to_the_last_bit(real, truth, points):
    data = build(real, points)
    found = blocks(write_inca_csv(data))
    for name in ("f1", "f2", "D", "g"):
        head, axis, values, _ = found[f"{data.prefix}_{name}"]
        assert (head[0], axis[:2], values[:2]) == ("CURVE", ["X_AXIS_PTS", "[1]"], ["", "[1]"])
        x = [float(v) for v in axis[2:]]
        assert bits(x, values[2:]) == truth(real).at(x)[name]
    assert found[f"{data.prefix}_f1"][0][1] == f"{data.prefix}_eta"
    shared = found[f"{data.prefix}_eta"][0]
    assert shared[0] == "AXIS_PTS"
    assert shared[2:] == found[f"{data.prefix}_f1"][1][2:]


def test_head_and_scalars(stored):
    content = write_inca_csv(build(stored))
    assert content.startswith(b'CALIBRATION VALUES V2.1;.;*;""\r\n')
    assert f"* digest: {stored.digest}\r\n".encode() in content
    assert blocks(content)["sedan_mass"][0] == ["VALUE", "[kg]", "1744.0"]
