"""Keys of Debian's minisign, a store of signed tables, and twenty ramps each fitted by itself."""

import shutil
from pathlib import Path

import pytest

from calib.fitting.fit import fit
from calib.store.minisign_keys import PublicKey, SecretKey, read_public_key, read_secret_key
from calib.store.store import Store
from calib.table.table import Table
from tests.store.golden.make import HERE
from tests.support.reference_car import CAR, REAL, noisy, ramp
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


def never() -> str:
    raise AssertionError("no password is needed")


@pytest.fixture(scope="session")
def golden() -> Path:
    """The folder of the files that Debian's minisign made."""
    return HERE


@pytest.fixture(scope="session")
def key(golden: Path) -> SecretKey:
    return read_secret_key(golden / "open.key", never)


@pytest.fixture(scope="session")
def public(golden: Path) -> PublicKey:
    return read_public_key(golden / "open.pub")


@pytest.fixture(scope="session")
def content(golden: Path) -> bytes:
    """A signature file."""
    return (golden / "open.minisig").read_bytes()


@pytest.fixture(scope="session")
def runs() -> list[Table]:
    driven = ramp(REAL)
    return [fit(CAR, [noisy(driven, seed)]) for seed in range(20)]
