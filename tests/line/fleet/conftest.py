"""Stops and folders of logs that the tests of the fleet share."""

import pytest

from calib.line.fleet.batch import run_batch
from tests.support.fleet_logs import Here, many, validating
from tests.support.reference_car import WET, cut, noisy, stop


@pytest.fixture(scope="session")
def stops():
    """Two stops that pass, and one without a lead-in, which is refused."""
    wet = noisy(stop(WET), 3)
    return [wet, noisy(stop(WET, pressure=30e5), 4), cut(wet, 1.8)]


@pytest.fixture(scope="session")
def fleet(tmp_path_factory, stops):
    """A folder of 24 logs, 8 of which are refused."""
    return many(tmp_path_factory.mktemp("fleet") / "logs", stops, 24)


@pytest.fixture(scope="session")
def undisturbed(fitted, fleet, tmp_path_factory):
    """results.parquet of the fleet, made without processes."""
    out = tmp_path_factory.mktemp("whole")
    return run_batch(validating(fitted), [str(fleet)], out, Here()).results.read_bytes()


@pytest.fixture
def six(tmp_path, stops, monkeypatch):
    """Six logs in logs/ of the working directory."""
    monkeypatch.chdir(tmp_path)
    many(tmp_path / "logs", stops, 6)
    return "logs"
