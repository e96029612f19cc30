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
def store(tmp_path):
    return Store(tmp_path / "tables")


@pytest.fixture
def three(store):
    """A store with three drafts."""
    for stiffness in (27.0, 28.0, 29.0):
        store.save(made_table(stiffness))
    return store


@pytest.fixture
def signed_store(tmp_path, seen_file):
    """sedan@1 and sedan@2 released and signed by Ada, wagon@1 a draft; nobody has seen it."""
    store = Store(tmp_path / "tables")
    store.save(made_table(27.0), RELEASE)
    store.save(made_table(28.0), RELEASE)
    store.save(made_table(name="wagon"))
    for version in ("sedan@1", "sedan@2"):
        sign(store, version, ADA)
    forget(seen_file)
    return store


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
