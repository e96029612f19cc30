"""One run at the station on the sample logs, shared by the tests that look at what it left."""

from dataclasses import replace
from pathlib import Path

import pytest

from calib.logs.read import read_log
from calib.physics.vehicle_file import read_vehicle
from calib.station.advice import LIMITS
from calib.station.identity import Identity
from calib.station.metrics import Car
from calib.station.station import StationOutcome, outcome, table_of, validated
from calib.table.store import save
from calib.table.version import Stored

SEDAN = Path(__file__).parents[2] / "sample_logs" / "sedan"
MARKUP = "<img src=x onerror=alert(1)>&\"'$"
"""A name that would do harm where it is not escaped, and a dollar that would start a formula."""


@pytest.fixture(scope="session")
def found() -> StationOutcome:
    """A car with a log and a serial number named in markup; basalt with wet pads fails it."""
    car = replace(read_vehicle(SEDAN / "vehicle.toml"), name="sedan")
    ramp, coast = (read_log(SEDAN / f"{n}.csv") for n in ("ramp_wet_asphalt", "coast"))
    stops = [read_log(SEDAN / f"{n}.csv") for n in ("dry_asphalt_stop", "basalt_wet_pads")]
    stops[0] = replace(stops[0], name=MARKUP, notes=(f"channel {MARKUP} was not taken",))
    identity = Identity(serial=MARKUP, vin="WVWZZZ1JZXW000001")
    table = table_of(car, [ramp], [coast], identity)
    results = [validated(table, log, LIMITS) for log in stops]
    return outcome(Car(table, [ramp], stops, results), [coast], LIMITS, identity)


@pytest.fixture(scope="session")
def kept(found: StationOutcome, tmp_path_factory: pytest.TempPathFactory) -> Stored:
    return save(found.table, tmp_path_factory.mktemp("line") / "tables")
