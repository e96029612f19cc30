from pathlib import Path

import pytest

from calib.car.vehicle_file import read_vehicle
from calib.estimation.limits import DEFAULTS
from calib.estimation.validate import validate_one
from calib.fitting.fit import fit
from calib.logs.log import Log
from calib.logs.read import read_log
from calib.run.events import run_events
from calib.show import log, stop, table
from calib.show.ramp import measure
from calib.show.sheet import Sheet
from calib.table.table import Table
from tests.support.tables import made_table

LOGS = Path(__file__).parents[2] / "sample_logs"
SEDAN, SIMULATION = LOGS / "sedan", LOGS / "simulation_study"


@pytest.fixture(scope="session")
def ramp() -> Log:
    return read_log(SEDAN / "ramp_wet_asphalt.csv")


@pytest.fixture(scope="session")
def transition() -> Log:
    return read_log(SEDAN / "transition_dry_to_basalt.csv")


@pytest.fixture(scope="session")
def sedan(ramp) -> Table:
    return fit(read_vehicle(SEDAN / "vehicle.toml"), [ramp, read_log(SEDAN / "coast.csv")])


@pytest.fixture(scope="session")
def stopped(sedan, transition):
    """The judged stop of ``transition``."""
    return validate_one(sedan, transition, None, DEFAULTS)


@pytest.fixture(scope="session")
def simulated() -> Sheet:
    """The paper's Section IV: the pads are 0.4, the vehicle file says 0.5 and 0.6."""
    right, wrong = (read_vehicle(SIMULATION / f"vehicle{x}.toml") for x in ("", "_wrong_pads"))
    simulated_ramp, run = (read_log(SIMULATION / f"{x}_noisy.parquet") for x in ("ramp", "stop"))
    result = validate_one(fit(right, [simulated_ramp]), run, wrong, DEFAULTS)
    return stop.of_validation(result, "sedan@1", wrong)


@pytest.fixture(scope="session", params=("table", "ramp", "stop", "simulation", "log"))
def sheet(request, sedan, ramp, transition):
    """A sheet of each kind."""
    return {
        "table": lambda: table.table_sheet(made_table(), "sedan@1"),
        "ramp": lambda: table.table_sheet(sedan, "sedan@1", (measure(sedan, ramp),)),
        "stop": lambda: stop.of_validation(request.getfixturevalue("stopped"), "sedan@1"),
        "simulation": lambda: request.getfixturevalue("simulated"),
        "log": lambda: log.log_sheet(log.whole_of(transition), run_events(transition)),
    }[request.param]()
