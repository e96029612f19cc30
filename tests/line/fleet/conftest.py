import pytest

from tests.support.fleet_logs import many
from tests.support.reference_car import WET, cut, noisy, stop


@pytest.fixture(scope="session")
def stops():
    """A stop that passes, one that passes too, one without lead-in, which will not do."""
    wet = noisy(stop(WET), 3)
    return [wet, noisy(stop(WET, pressure=30e5), 4), cut(wet, 1.8)]


@pytest.fixture(scope="session")
def sixty(tmp_path_factory, stops):
    return many(tmp_path_factory.mktemp("sixty") / "logs", stops, 60)


@pytest.fixture
def six(tmp_path, stops, monkeypatch):
    """Six logs in logs/ of the working directory."""
    monkeypatch.chdir(tmp_path)
    many(tmp_path / "logs", stops, 6)
    return "logs"
