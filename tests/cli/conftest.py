import json
from pathlib import Path

import pytest

from calib.store.store import Store
from tests.support.tables import made_table


@pytest.fixture
def on_store(brake_cal, store):
    """Run a command of `brake-cal tables` on the store."""
    return lambda *words: brake_cal("tables", *words, "--store", store)


@pytest.fixture
def tables(on_store, stored):
    """Run a command of `brake-cal tables` on a store that holds sedan@1."""
    return on_store


@pytest.fixture
def two(stored, store):
    """The store of ``stored`` with sedan@2 of another stiffness, and wagon@1."""
    Store(store).save(made_table(28.0))
    Store(store).save(made_table(name="wagon"))
    return store


@pytest.fixture
def refused(brake_cal, tmp_path):
    """Assert that a command ends with a code, prints no result, and writes nothing."""

    is_in_folder = Path.cwd() == tmp_path  # elsewhere are too many files to read

    def contents():
        paths = Path().rglob("*") if is_in_folder else ()
        return {path: path.read_bytes() for path in paths if path.is_file()}

    def run(code, *words):
        contents_before = contents()
        ran = brake_cal(*words)
        assert (ran.code, ran.result) == (code, ""), ran.err
        assert "Traceback" not in ran.err
        assert contents() == contents_before
        return ran

    return run


def parsed(ran):
    """Return the JSON document that a command printed."""
    return json.loads(ran.out)
