"""A store of signed tables; only the tests that name these fixtures get it."""

import shutil

import pytest

from calib.store.store import Store
from tests.support.signing import ADA, RELEASE
from tests.support.tables import made_table


@pytest.fixture
def signed_store(tmp_path):
    """sedan@1 and sedan@2 released and signed by Ada, wagon@1 a draft."""
    made = Store(tmp_path / "tables")
    made.save(made_table(27.0), RELEASE)
    made.save(made_table(28.0), RELEASE)
    made.save(made_table(name="wagon"))
    for version in ("sedan@1", "sedan@2"):
        made.sign(version, ADA, "Ada")
    return made


@pytest.fixture
def copy(signed_store, tmp_path):
    """Make a copy of the store as it is now."""

    def of(name="copy"):
        shutil.copytree(signed_store.folder, tmp_path / name)
        return Store(tmp_path / name)

    return of
