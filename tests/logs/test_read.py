"""Reading a log: the good ones give SI, each bad one is refused with its reason."""

import hashlib

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.logs.read import REQUIRED, read_log
from tests.support.refusals import refusal

NAMES = ["time", "p_mc", "a_x", "omega_fl", "omega_fr", "omega_rl", "omega_rr"]
UNITS = dict(zip(NAMES, ["s", "bar", "m/s^2", *["rad/s"] * 4], strict=True))


def table(rows=60, **more):
    """Distinct decimals in every cell: row i, column j; ``more`` cells by channel."""
    columns = {f"{n} [{UNITS[n]}]": [f"{10 * j + i / 100:.2f}" for i in range(rows)]
               for j, n in enumerate(NAMES)}  # fmt: skip
    return columns | {f"{n} [m/s]": cells for n, cells in more.items()}


def with_cells(name, cells):
    """The table in which a channel has other cells from some rows on, by the first row."""
    columns = table()
    head = f"{name} [{UNITS[name]}]"
    for row, values in cells.items():
        columns[head][row : row + len(values)] = values
    return columns


def write(tmp_path, columns, name="run.csv"):
    path = tmp_path / name
    rows = zip(*columns.values(), strict=True)
    path.write_text("\n".join([",".join(columns), *map(",".join, rows), ""]))
    return path


def refused(path, **keywords):
    return refusal(read_log, path, kind=LogError, names=path, **keywords)


def test_gives_si(tmp_path):
    path = write(tmp_path, table())
    log = read_log(path)
    assert (log.name, list(log.channels)) == ("run", NAMES)
    np.testing.assert_allclose(log.time, np.arange(60) / 100)
    np.testing.assert_allclose(log["p_mc"], (10 + np.arange(60) / 100) * 1e5)
    np.testing.assert_allclose(log["omega_rr"], 60 + np.arange(60) / 100)
    assert log.ignored == log.notes == ()
    assert log.truth == {}
    assert log.digest == hashlib.sha256(path.read_bytes()).hexdigest()


def test_a_file_may_hold_the_log_of_another_name(tmp_path):
    log = read_log("line 7/ramp.csv", file=write(tmp_path, table()))
    assert (log.name, log.source, log.time.size) == ("ramp", "line 7/ramp.csv", 60)


def test_truth_and_foreign_columns_are_kept_apart(tmp_path):
    more = {"true_Tb_fl [kN*m]": "1.5", "true_mu_pad_f [%]": "38", "true_hue [hue]": "3", "x": "a"}
    log = read_log(write(tmp_path, table() | {k: [v] * 60 for k, v in more.items()}))
    expected = pytest.approx({"true_Tb_fl": 1500, "true_mu_pad_f": 0.38})
    assert {name: values[0] for name, values in log.truth.items()} == expected
    assert not any(name.startswith("true_") for name in log.channels)
    assert log.ignored == ("true_hue", "x")


def test_what_is_no_log(tmp_path):
    refused(tmp_path / "none.csv")
    refused(tmp_path)
    assert ".parquet" in refused(write(tmp_path, table(), "run.xlsx"))
    for text in ("", "\n\n", ",".join(table()) + "\n"):
        (tmp_path / "run.csv").write_text(text)
        refused(tmp_path / "run.csv")


@pytest.mark.parametrize("name", REQUIRED)
def test_missing_channel(tmp_path, name):
    path = write(tmp_path, {k: v for k, v in table().items() if not k.startswith(name)})
    assert name in refused(path)
    if name == "time":
        refused(path, require=())
    else:
        assert name not in read_log(path, require=())


@pytest.mark.parametrize(
    ("old", "new", "named"),
    [
        ("omega_fl [", "omega_lf [", "'omega_lf' meant to be omega_fl"),
        ("omega_rl [rad/s]", "a_x [g]", "a_x"),
        ("p_mc [bar]", "p_mc", "[Pa]"),
        ("[bar]", "[barg]", "'barg'"),
        ("[bar]", "[N]", "force"),
    ],
)
def test_names_and_units_that_do_not_fit(tmp_path, old, new, named):
    path = write(tmp_path, table())
    path.write_text(path.read_text().replace(old, new, 1))
    assert named in refused(path)


@pytest.mark.parametrize(
    ("columns", "named"),
    [
        (table(49), "49"),
        (with_cells("a_x", {7: [""] * 29 + ["NaN"]}), "a_x: no value in 30 of 60 rows"),
        (with_cells("a_x", {7: ["inf"]}), "a_x"),
        (with_cells("a_x", {7: ["1e200"]}), "a_x: row 8"),
        (with_cells("p_mc", {0: [""] * 60}), "p_mc"),
        (with_cells("time", {10: ["0.05"]}), "row 11"),
        (with_cells("time", {10: ["0.09"]}), "row 11"),
    ],
)
def test_values_that_are_no_run(tmp_path, columns, named):
    assert named in refused(write(tmp_path, columns))


@pytest.mark.parametrize(
    ("head", "cells"),
    [
        ("v [m/s]", [""] * 60),
        ("v [m/s]", ["20"] * 20 + [""] * 30 + ["20"] * 10),
        ("v", ["20"] * 60),
    ],
    ids=["empty", "holes", "no unit"],
)
def test_an_optional_channel_that_is_not_whole_is_left_out_and_said(tmp_path, head, cells):
    path = write(tmp_path, table() | {head: cells})
    log = read_log(path)
    assert "v" not in log
    assert log.notes
    if head == "v":
        refused(path, require=("v",))


def test_a_lost_value_is_interpolated_and_the_ends_are_cut_and_that_is_said(tmp_path):
    log = read_log(write(tmp_path, with_cells("a_x", {7: [""], 9: ["NaN"]})))
    np.testing.assert_allclose(log["a_x"], 20 + np.arange(60) / 100)
    assert len(log.notes) == 1
    columns = with_cells("omega_fl", {0: [""]}) | table(v=["", "", *["20"] * 57, ""])
    columns["omega_fl [rad/s]"][0] = ""
    log = read_log(write(tmp_path, columns))
    assert log.time.size == 57
    assert np.all(log["v"] == 20.0)
    assert len(log.notes) == 1
