import os
import tempfile
from dataclasses import dataclass
from pathlib import Path

import pytest
import scipy.linalg.lapack  # noqa: F401  # so that its linear algebra is limited below
from hypothesis import settings
from threadpoolctl import threadpool_limits

from calib.store.state import StateDecision
from calib.store.store import Store
from calib.store.version import Stored
from calib.table.table import Table
from tests.support.browser import started
from tests.support.command import fit_once, typed
from tests.support.reference_car import CAR, REAL, noisy, ramp
from tests.support.shared import FOLDER
from tests.support.tables import made_table

# The first example of a test imports what it needs, on any machine: no deadline is fair.
settings.register_profile("brake-cal", deadline=None, max_examples=30, derandomize=True)
settings.load_profile("brake-cal")

threadpool_limits(1, user_api="blas")  # as `cli.main` has it


def pytest_configure(config: pytest.Config) -> None:
    """Make the folder of `shared` results, which the workers inherit."""
    if FOLDER not in os.environ:
        folder = tempfile.TemporaryDirectory()
        os.environ[FOLDER] = folder.name
        # else each command that a test starts compiles all modules
        os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
        config.add_cleanup(folder.cleanup)


@pytest.fixture
def table() -> Table:
    return made_table()


@pytest.fixture(scope="session")
def fitted() -> Table:
    """The table of the reference car from one ramp."""
    return fit_once(CAR, [noisy(ramp(REAL), 1)])


@pytest.fixture
def store(tmp_path: Path) -> Path:
    return tmp_path / "tables"


@pytest.fixture
def stored(table: Table, store: Path) -> Stored:
    """sedan@1, released."""
    return Store(store).save(table, StateDecision("released", "made for a test"))


@dataclass(frozen=True)
class Ran:
    code: int
    out: str
    err: str

    @property
    def result(self) -> str:
        """What stdout holds besides the one document of an error."""
        return "" if self.out.startswith('{\n  "schema": 1,\n  "error": {') else self.out


@pytest.fixture
def brake_cal(capsys, monkeypatch):
    """Run the command line in this process, as the shell would, 120 columns wide."""
    monkeypatch.setenv("COLUMNS", "120")

    def run(*arguments: object) -> Ran:
        return Ran(typed(*arguments), *capsys.readouterr())

    return run


@pytest.fixture
def seen_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file of what was seen of stores, of a user who has seen none."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    return tmp_path / "state" / "brake-cal" / "seen.json"


@pytest.fixture(scope="session")
def browser():
    with started() as driver:
        yield driver
