import pytest

from tests.support.recordings import write_dbc


@pytest.fixture(scope="module")
def bus_folder(tmp_path_factory):
    """A folder with the DBC of the bus and a map that names it, `map.toml`."""
    path = tmp_path_factory.mktemp("bus")
    write_dbc(path)
    return path
