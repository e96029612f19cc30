"""`brake-cal check` as the shell runs it."""

import json
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from calib.base.errors import ChannelMapError
from calib.logs.write import write_csv
from cli.check import check
from tests.support.made_runs import changed, made_run

SEDAN = Path(__file__).parents[2] / "sample_logs/sedan"


def run(*arguments):
    app = typer.Typer()
    app.command()(check)
    return CliRunner().invoke(app, [str(a) for a in arguments])


def test_usable_logs():
    result = run(SEDAN / "ramp_wet_asphalt.csv", SEDAN / "coast.csv")
    assert result.exit_code == 0
    first, second = result.stdout.splitlines()
    assert first.startswith("usable for fit, validate, diagnose: ")
    assert second.startswith("usable for fit as a coast log, diagnose: ")
    assert "-v shows what is in each log" in result.stderr


def test_details_with_v(brake_cal):
    ran = brake_cal("check", SEDAN / "coast.csv", "-v")
    assert "not usable" in ran.out  # for a fit alone
    assert "2000 samples" in ran.out
    assert "-v shows" not in ran.err


def test_a_coast_without_v_is_a_coast_log_still(tmp_path):
    path = tmp_path / "coast.csv"
    write_csv(changed(made_run(lambda t: 0.0 * t), v=None), path)
    result = run(path)
    assert result.exit_code == 0
    assert result.stdout.startswith("usable for fit as a coast log: ")


def test_useless_log(tmp_path):
    path = tmp_path / "run.csv"
    write_csv(changed(made_run(), p_mc=None), path)
    result = run(path)
    assert result.exit_code == 1
    assert "p_mc is missing" in result.stdout


def test_unreadable_log_does_not_hide_the_others(tmp_path):
    result = run(tmp_path / "none.csv", SEDAN / "coast.csv")
    assert result.exit_code == 3
    assert "coast.csv" in result.stdout
    assert "no such file" in result.stderr


def test_json_is_one_document(tmp_path):
    result = run("--json", SEDAN / "coast.csv", tmp_path / "none.csv")
    assert result.exit_code == 3
    document = json.loads(result.stdout)
    assert document["logs"][0]["log"] == "coast"
    assert "no such file" in document["unreadable"][0]["error"]
    assert document["error"]["exit_code"] == 3
    assert document["error"]["what"] == "no such file"
    assert "error" not in json.loads(run("--json", SEDAN / "coast.csv").stdout)


def test_channel_map(tmp_path):
    log, channel_map = tmp_path / "run.csv", tmp_path / "map.toml"
    write_csv(changed(made_run(), a_x=-made_run()["a_x"]), log)
    channel_map.write_text('schema = 1\n[channels.a_x]\nsource = "a_x"\nsign = -1\n')
    assert run(log).exit_code == 1
    assert run(log, "--map", channel_map).exit_code == 0


def test_broken_channel_map(tmp_path):
    result = run(SEDAN / "coast.csv", "--map", tmp_path / "none.toml")
    assert isinstance(result.exception, ChannelMapError)
    assert result.exception.exit_code == 3


@pytest.mark.parametrize("flag", ["--help"])
def test_help(flag):
    assert "Exit code 1" in run(flag).stdout
