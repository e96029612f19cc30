"""A store, a store of signed tables, and eight ramps each fitted by itself."""

import shutil

import pytest

from calib.fitting.fit import fit
from calib.store.signature import sign
from calib.store.store import Store
from calib.table.table import Table
from tests.support.reference_car import CAR, REAL, noisy, ramp
from tests.support.signing import ADA, RELEASE, forget
from tests.support.tables import made_table


@pytest.fixture
def three(tmp_path):
    """A store with three drafts."""
    made = Store(tmp_path / "tables")
    for stiffness in (27.0, 28.0, 29.0):
        made.save(made_table(stiffness))
    return made


@pytest.fixture
def signed_store(tmp_path, seen):
    """sedan@1 and sedan@2 released and signed by Ada, wagon@1 a draft; nobody has seen it."""
    made = Store(tmp_path / "tables")
    made.save(made_table(27.0), RELEASE)
    made.save(made_table(28.0), RELEASE)
    made.save(made_table(name="wagon"))
    for version in ("sedan@1", "sedan@2"):
        sign(made, version, ADA)
    forget(seen)
    return made


@pytest.fixture
def copy(signed_store, tmp_path):
    """Make a copy of the store as it is now."""

    def make(name):
        shutil.copytree(signed_store.folder, tmp_path / name)
        return Store(tmp_path / name)

    return make


@pytest.fixture(scope="session")
def runs() -> list[Table]:
    driven = ramp(REAL)
    return [fit(CAR, [noisy(driven, seed)]) for seed in range(8)]
