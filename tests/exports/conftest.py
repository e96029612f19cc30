from pathlib import Path

import pytest

from calib.store.store import Store
from calib.store.version import Stored

ROOT = Path(__file__).parents[2]


@pytest.fixture(params=["sedan-2up", "sedan-sim", "escort"])
def real(request) -> Stored:
    """A table of the repository's own store."""
    return Store(ROOT / "tables").load(request.param)
