"""What a proposed map says of the buses is read back as the map that the log was opened with."""

import pytest

from calib.logs.channel_map import ChannelMap, DatabaseFile
from calib.logs.channel_map_file import read_channel_map
from calib.suggest.proposal import Suggestion
from calib.suggest.written import to_toml


@pytest.mark.parametrize("sources", [None, (), (0x0B, 0x21)])
@pytest.mark.parametrize("by_bus", [False, True])
def test_databases_and_source_addresses_are_kept(tmp_path, sources, by_bus):
    files = (DatabaseFile(tmp_path / "a.dbc"), DatabaseFile(tmp_path / "b.kcd", "Motor"))
    for file in files:
        file.path.write_text("")
    buses = (("1", files[:1]), ("can0", files[1:])) if by_bus else ()
    used = ChannelMap("old.toml", {}, dbc=() if by_bus else files, buses=buses, j1939=sources)
    found = Suggestion("x.blf", (), (), {}, {}, ())
    written = tmp_path / "map.toml"
    written.write_text(to_toml(found, used, tmp_path) + '[channels.v]\nsource = "speed"\n')
    again = read_channel_map(written)
    assert (again.dbc, again.buses, again.j1939) == (used.dbc, used.buses, used.j1939)
