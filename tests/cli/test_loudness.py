"""-q and -v."""

import re

import pytest

from calib.help.samples import sample_logs
from tests.support.terminal import on_a_terminal

SEDAN = sample_logs() / "sedan"
FIT = ("fit", SEDAN / "ramp_wet_asphalt.csv", "--vehicle", SEDAN / "vehicle.toml")


@pytest.fixture(scope="module")
def said(tmp_path_factory):
    return tmp_path_factory.mktemp("store")


def test_quiet_prints_the_same_result_and_nothing_else(brake_cal, said, tmp_path):
    usual = brake_cal(*FIT, "--store", tmp_path / "a")
    quiet = brake_cal(*FIT, "--store", tmp_path / "b", "-q")
    before = brake_cal("-q", *FIT, "--store", tmp_path / "c")
    assert "fitting sedan-2up" in usual.err
    assert quiet.err == before.err
    assert "warning:" in quiet.err or quiet.err == ""
    assert "fitting" not in quiet.err
    assert quiet.out == usual.out.replace(str(tmp_path / "a"), str(tmp_path / "b"))


@pytest.mark.parametrize("words", [("-q", "-v", "check"), ("-v", "check", "-q"), ("check", "-qv")])
def test_quiet_and_verbose_exclude_each_other(brake_cal, words):
    ran = brake_cal(*words, SEDAN / "coast.csv")
    assert ran.code == 2
    assert "-q and -v exclude each other" in ran.err
    assert ran.out == ""


def test_quiet_hides_no_error(brake_cal, tmp_path):
    ran = brake_cal("check", tmp_path / "none.csv", "-q")
    assert "no such file" in ran.err


def test_verbose_tells_what_was_read_and_the_time(brake_cal, tmp_path):
    ran = brake_cal(*FIT, "--store", tmp_path, "-v")
    assert re.search(r"read .*ramp_wet_asphalt\.csv: \d+ samples, .* SHA-256 [0-9a-f]{12}", ran.err)
    assert re.search(r"took \d+\.\d s, exit code 0\n$", ran.err)


def test_one_run_does_not_hush_the_next(brake_cal):
    brake_cal("tables", "list", "-q")
    assert "brake-cal.toml" in brake_cal("settings").err


def test_progress_is_drawn_on_a_terminal_and_never_with_q(tmp_path):
    words = (*FIT, "--store", tmp_path)
    told, seen = on_a_terminal(words, tmp_path, TERM="xterm")
    assert "reading ramp_wet_asphalt.csv" in seen
    assert "\u2501" in seen
    quiet, nothing = on_a_terminal((*words, "-q"), tmp_path, TERM="xterm")
    assert "\u2501" not in nothing
    assert "reading" not in nothing
    assert quiet.splitlines()[1:] == told.splitlines()[1:]  # the first says: already stored
