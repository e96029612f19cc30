"""One run at the station on the sample logs, shared by the tests that look at what it left."""

import pytest

from calib.line.station.station import StationOutcome
from calib.store.store import Store
from calib.store.version import Stored
from tests.support.station_run import failed_car


@pytest.fixture(scope="session")
def outcome() -> StationOutcome:
    return failed_car()


@pytest.fixture(scope="session")
def stored(outcome: StationOutcome, tmp_path_factory: pytest.TempPathFactory) -> Stored:
    return Store(tmp_path_factory.mktemp("line") / "tables").save(outcome.table)
