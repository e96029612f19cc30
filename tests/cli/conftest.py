import json

import pytest

from calib.store.store import Store
from tests.support.tables import made_table


@pytest.fixture
def tables(brake_cal, stored, store):
    """Run a command of `brake-cal tables` on a store that holds sedan@1."""

    def run(*arguments):
        return brake_cal("tables", *arguments, "--store", store)

    return run


@pytest.fixture
def two(stored, store):
    """That store with sedan@2 of another stiffness, and wagon@1."""
    Store(store).save(made_table(28.0))
    Store(store).save(made_table(name="wagon"))
    return store


@pytest.fixture
def document():
    """The one JSON document on stdout, of a command that said nothing else."""

    def of(ran):
        assert ran.err == ""
        return json.loads(ran.out)

    return of
