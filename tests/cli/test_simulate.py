"""`brake-cal simulate` as the shell runs it."""

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from calib.logs.read import read_log
from cli.console import begin_run
from cli.main import app
from tests.cli.conftest import parsed

ROOT = Path(__file__).parents[2]
SEDAN = ROOT / "sample_logs/sedan"
VEHICLE = SEDAN / "vehicle.toml"


def run(*words):
    begin_run()  # no settings of another test
    return CliRunner().invoke(app, ["simulate", *map(str, words)])


def test_a_log_is_replayed_on_its_own_clock(tmp_path):
    out = tmp_path / "sim.parquet"
    source = SEDAN / "ramp_wet_asphalt.csv"
    result = run(source, "--vehicle", VEHICLE, "--out", out)
    assert result.exit_code == 0
    assert "replaying" in result.stderr
    log, sim = read_log(source), read_log(out)
    assert np.array_equal(sim.time, log.time[: sim.time.size])
    # what is replayed is the pressure without the noise of its sensor: 0.15 bar, four sigma at most
    noise = sim["p_mc"] - log["p_mc"][: sim.time.size]
    assert np.abs(noise).max() <= 0.6e5
    assert noise.std() < 0.16e5
    assert "true_Tb_fl" in sim.truth
    assert list(tmp_path.iterdir()) == [out]


def test_noise_is_repeatable_and_a_model_is_obeyed(tmp_path):
    model = tmp_path / "model.toml"
    model.write_text("schema = 1\n[pads]\nfront = 0.2\n")
    written = {}
    for name, more in {
        "a": ("--noise", 1),
        "b": ("--noise", 1),
        "c": ("--noise", 2),
        "d": ("--model", model),
    }.items():
        out = tmp_path / f"{name}.csv"
        result = run("--manoeuvre", "stop", "--vehicle", VEHICLE, "--out", out, *more)
        assert result.exit_code == 0
        written[name] = out
    assert written["a"].read_bytes() == written["b"].read_bytes() != written["c"].read_bytes()
    assert set(read_log(written["d"]).truth["true_mu_pad_f"]) == {0.2}


@pytest.mark.parametrize(
    "arguments",
    [
        (),
        (SEDAN / "coast.csv", "--manoeuvre", "ramp"),
        (SEDAN / "coast.csv", "--speed", "20 m/s"),
        ("--manoeuvre", "rmap"),
        ("--manoeuvre", "coast", "--pressure", "10 bar"),
        ("--manoeuvre", "ramp", "--speed", "20"),
        ("--manoeuvre", "ramp", "--speed", "20 bar"),
        ("--manoeuvre", "ramp", "--rate", 5),
        ("--manoeuvre", "ramp", "--noise", -1),
    ],
)
def test_usage_errors_end_with_2_and_write_nothing(tmp_path, arguments):
    result = run(*arguments, "--vehicle", VEHICLE, "--out", tmp_path / "sim.csv")
    assert result.exit_code == 2
    assert not list(tmp_path.iterdir())


def test_simulated_manoeuvres_are_fitted_and_validated(brake_cal, tmp_path):
    for seed, (name, more) in enumerate(
        {"ramp": ("--duration", "8 s"), "coast": (), "stop": ("--pressure", "28 bar")}.items()
    ):
        assert brake_cal("simulate", "--manoeuvre", name, *more, "--noise", seed, "--vehicle",
                         VEHICLE, "--out", tmp_path / f"{name}.csv").code == 0  # fmt: skip
    ramp, coast, stop = (tmp_path / f"{name}.csv" for name in ("ramp", "coast", "stop"))
    store = ("--store", tmp_path / "tables")
    assert brake_cal("check", ramp, coast, stop).code == 0
    fitted = brake_cal("fit", ramp, coast, "--vehicle", VEHICLE, *store, "--json")
    assert fitted.code == 0
    judged = brake_cal("validate", "sedan-2up", stop, *store, "--json")
    assert judged.code == 0
    figures = parsed(judged)["logs"][0]["figures"]
    for axle in "fr":  # the pads of the vehicle file
        mu, half = figures[f"pad_friction_{axle}"], figures[f"interval_{axle}"]
        assert abs(mu - 0.38) < mu * half < 0.05
