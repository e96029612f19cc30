"""Reading a log: the good ones give SI, each bad one is refused with its reason."""

import hashlib
from pathlib import Path

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.logs.read import REQUIRED, read_log
from tests.support.refusals import refusal

SAMPLES = Path(__file__).parents[2] / "sample_logs"
NAMES = ["time", "p_mc", "a_x", "omega_fl", "omega_fr", "omega_rl", "omega_rr"]
UNITS = dict(zip(NAMES, ["s", "bar", "m/s^2", *["rad/s"] * 4], strict=True))


def table(rows=60):
    """Distinct decimals in every cell: row i, column j."""
    values = {
        name: [f"{10 * j + i / 100:.2f}" for i in range(rows)] for j, name in enumerate(NAMES)
    }
    return {f"{name} [{UNITS[name]}]": cells for name, cells in values.items()}


def csv_text(columns, delimiter=","):
    rows = zip(*columns.values(), strict=True)
    return "\n".join([delimiter.join(columns), *(delimiter.join(row) for row in rows), ""])


def write(tmp_path, text, name="run.csv"):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def refused(path, *arguments, **keywords):
    return refusal(read_log, path, *arguments, kind=LogError, names=path, **keywords)


def test_gives_si(tmp_path):
    log = read_log(write(tmp_path, csv_text(table())))
    assert log.name == "run"
    assert list(log.channels) == NAMES
    np.testing.assert_allclose(log.time, np.arange(60) / 100)
    np.testing.assert_allclose(log["p_mc"], (10 + np.arange(60) / 100) * 1e5)
    np.testing.assert_allclose(log["omega_rr"], 60 + np.arange(60) / 100)
    assert log.ignored == log.notes == ()
    assert log.truth == {}


def test_converts_units_at_the_door(tmp_path):
    columns = table()
    columns["p_mc [MPa]"] = columns.pop("p_mc [bar]")
    columns["a_x [g]"] = columns.pop("a_x [m/s^2]")
    columns["v [km/h]"] = ["36"] * 60
    log = read_log(write(tmp_path, csv_text(columns)))
    assert log["p_mc"][0] == pytest.approx(10e6)
    assert log["a_x"][0] == pytest.approx(20 * 9.80665)
    assert log["v"][0] == 10


def test_digest_is_that_of_the_bytes(tmp_path):
    path = write(tmp_path, csv_text(table()))
    assert read_log(path).digest == hashlib.sha256(path.read_bytes()).hexdigest()


def test_truth_is_kept_apart(tmp_path):
    columns = {
        **table(),
        "true_Tb_fl [kN*m]": ["1.5"] * 60,
        "true_mu_pad_f [%]": ["38"] * 60,
        "true_colour [hue]": ["3"] * 60,
    }
    log = read_log(write(tmp_path, csv_text(columns)))
    assert set(log.truth) == {"true_Tb_fl", "true_mu_pad_f"}
    assert log.truth["true_Tb_fl"][0] == pytest.approx(1500)
    assert log.truth["true_mu_pad_f"][0] == pytest.approx(0.38)
    assert not any(name.startswith("true_") for name in log.channels)
    assert log.ignored == ("true_colour",)


def test_foreign_columns_are_listed_not_read(tmp_path):
    log = read_log(write(tmp_path, csv_text({**table(), "note": ["wet"] * 60})))
    assert log.ignored == ("note",)


def test_all_samples_are_read():
    files = sorted(p for p in SAMPLES.glob("*/*") if p.suffix in {".csv", ".parquet"})
    files = [p for p in files if p.parent.name != "real"]
    assert len(files) == 14
    for path in files:
        log = read_log(path)
        assert log.sample_time == pytest.approx(0.005)
        assert log["p_mc"].max() < 200e5


def test_no_file(tmp_path):
    assert "no such file" in refused(tmp_path / "none.csv")


def test_directory(tmp_path):
    assert "directory" in refused(tmp_path)


def test_unknown_ending(tmp_path):
    message = refused(write(tmp_path, "x", "run.xlsx"))
    assert "'.xlsx'" in message
    assert ".parquet" in message


@pytest.mark.parametrize("text", ["", "\n\n", csv_text(table()).split("\n")[0] + "\n"])
def test_nothing_in_it(tmp_path, text):
    message = refused(write(tmp_path, text))
    assert "empty" in message or "no samples" in message


def test_too_few_samples(tmp_path):
    assert "only 49 samples" in refused(write(tmp_path, csv_text(table(49))))
    read_log(write(tmp_path, csv_text(table(50))))


@pytest.mark.parametrize("name", REQUIRED)
def test_missing_channel(tmp_path, name):
    columns = {head: cells for head, cells in table().items() if not head.startswith(name)}
    message = refused(write(tmp_path, csv_text(columns)))
    assert f"channel {name} missing" in message
    assert "--map" in message


def test_misspelt_channel_is_suggested(tmp_path):
    columns = table()
    columns["omega_lf [rad/s]"] = columns.pop("omega_fl [rad/s]")
    message = refused(write(tmp_path, csv_text(columns)))
    assert "is 'omega_lf' meant to be omega_fl?" in message


def test_channel_that_is_not_required_may_be_missing(tmp_path):
    columns = {head: cells for head, cells in table().items() if not head.startswith("p_mc")}
    assert "p_mc" not in read_log(write(tmp_path, csv_text(columns)), require=())


def test_time_is_always_required(tmp_path):
    columns = {head: cells for head, cells in table().items() if not head.startswith("time")}
    assert "channel time missing" in refused(write(tmp_path, csv_text(columns)), require=())


def test_duplicate_channel(tmp_path):
    columns = {**table(), "a_x [g]": ["0.1"] * 60}
    message = refused(write(tmp_path, csv_text(columns)))
    assert "a_x: the channel occurs twice" in message


def test_missing_unit(tmp_path):
    message = refused(write(tmp_path, csv_text(table()).replace("p_mc [bar]", "p_mc")))
    assert "p_mc: the unit is missing" in message
    assert "[Pa]" in message


def test_an_optional_channel_without_unit_is_left_out_and_said(tmp_path):
    columns = {**table(), "v": ["20"] * 60}
    path = write(tmp_path, csv_text(columns))
    log = read_log(path)
    assert "v" not in log
    assert log.ignored == ("v",)
    assert log.notes == (
        "v has no unit and was left out: name it in the header or in a channel map",
    )
    assert "v: the unit is missing" in refused(path, require=("v",))


def test_unknown_unit(tmp_path):
    message = refused(write(tmp_path, csv_text(table()).replace("[bar]", "[barg]")))
    assert "p_mc" in message
    assert "'barg'" in message
    assert "did you mean 'bar'" in message


def test_unit_of_another_quantity(tmp_path):
    message = refused(write(tmp_path, csv_text(table()).replace("[bar]", "[N]")))
    assert "'N' is a unit of force, not of pressure" in message


def test_hole(tmp_path):
    columns = table()
    columns["a_x [m/s^2]"][7:37] = [*[""] * 29, "NaN"]
    message = refused(write(tmp_path, csv_text(columns)), require=())
    assert "a_x: no value in 30 of 60 rows, first in row 8 at 0.070 s" in message


def test_a_lost_value_of_a_smooth_channel_is_interpolated_and_said(tmp_path):
    columns = table()
    columns["a_x [m/s^2]"][7] = ""
    columns["a_x [m/s^2]"][9] = "NaN"
    log = read_log(write(tmp_path, csv_text(columns)))
    np.testing.assert_allclose(log["a_x"], 20 + np.arange(60) / 100)
    assert log.notes == (
        "a_x: 2 of 60 rows have no value and were interpolated, the first at 0.070 s",
    )


def test_infinite_value(tmp_path):
    columns = table()
    columns["a_x [m/s^2]"][7] = "inf"
    assert "an infinite value in 1 of 60 rows" in refused(write(tmp_path, csv_text(columns)))


def test_empty_channel(tmp_path):
    columns = {**table(), "p_mc [bar]": [""] * 60}
    path = write(tmp_path, csv_text(columns))
    assert "p_mc: the channel is empty" in refused(path)
    log = read_log(path, require=())
    assert "p_mc" not in log
    assert log.notes == ("p_mc is empty and was left out",)


def test_optional_channel_with_holes_is_left_out_and_said(tmp_path):
    columns = {**table(), "v [m/s]": ["20"] * 20 + [""] * 30 + ["20"] * 10}
    log = read_log(write(tmp_path, csv_text(columns)))
    assert "v" not in log
    assert log.notes[-1] == "v has no value in 30 of 60 rows, first in row 21, and was left out"


def test_a_log_begins_with_the_first_message_of_every_channel_and_ends_with_the_last(tmp_path):
    columns = {**table(), "v [m/s]": ["", ""] + ["20"] * 57 + [""]}
    columns["omega_fl [rad/s]"] = ["", *columns["omega_fl [rad/s]"][1:]]
    log = read_log(write(tmp_path, csv_text(columns)))
    assert log.time.size == 57
    assert np.all(log["v"] == 20.0)
    assert log.notes == (
        "omega_fl, v: no value at the start or the end; "
        "the first 2 and the last 1 rows were left out",
    )


@pytest.mark.parametrize(("cell", "words"), [("0.05", "goes back"), ("0.09", "does not increase")])
def test_time_that_does_not_run(tmp_path, cell, words):
    columns = table()
    columns["time [s]"][10] = cell
    message = refused(write(tmp_path, csv_text(columns)))
    assert f"time {words} in row 11" in message


def test_value_that_only_a_damaged_file_holds(tmp_path):
    columns = table()
    columns["a_x [m/s^2]"][7] = "1e200"
    assert "a_x: row 8 holds 1e+200" in refused(write(tmp_path, csv_text(columns)))
