import pytest

from calib.base.errors import LogError
from calib.logs.read import read_log
from tests.support.recordings import write_bus, write_dbc
from tests.support.refusals import refusal


@pytest.fixture(scope="session")
def bus_folder(tmp_path_factory):
    """A folder with the DBC of the bus, a map that names it, and the run in three formats."""
    path = tmp_path_factory.mktemp("bus")
    write_dbc(path)
    write_bus(path / "whole.asc")
    for ending in ("blf", "log"):
        write_bus(path / f"whole.{ending}", 1.7e9)
    return path


@pytest.fixture(scope="session")
def read_bus(bus_folder):
    """A function that writes a file of this name and reads it with the map."""

    def read(name, data, map_name="map.toml"):
        path = bus_folder / name
        path.write_bytes(data if isinstance(data, bytes) else data.encode())
        return read_log(path, bus_folder / map_name)

    return read


@pytest.fixture(scope="session")
def refused_bus(read_bus):
    """A function that writes a file and returns the message with which it is refused."""
    return lambda name, data: refusal(read_bus, name, data, kind=LogError)
