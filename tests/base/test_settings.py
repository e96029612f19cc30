"""The settings file: where it is found, which keys it may have, and its mistakes."""

from pathlib import Path

import pytest

from calib.base.errors import SettingsError
from calib.base.names import SETTINGS_FILE
from calib.base.settings_file import find_project, read_settings

KEY = "RWQf6LRCGA9i53mlYecO4IzT51TGPpvWucNSCh1CBM0QTaLn73Y7GFO3"
"""The public key in the manual of minisign."""

WHOLE = f"""
schema = 1
store = "tables"
vehicle = "cars/car.toml"
map = "/etc/map.toml"
limits = "../line.toml"
require_signed = true
by = "Ada Lovelace"
[station]
name = "end of line 2"
golden = "car@1"
export = ["dcm", "json"]
[keys]
public = "{KEY}"
"""


@pytest.fixture
def written(tmp_path, monkeypatch):
    """Write a settings file into a folder, with the working folder in `project/sub`."""
    (tmp_path / "project" / "sub").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "project" / "sub")

    def write(text, folder=".."):
        path = Path(folder) / SETTINGS_FILE
        path.write_text(text)
        return path

    return write


def test_the_nearest_file_counts(written, tmp_path):
    sub = tmp_path / "project" / "sub"
    assert find_project().file is None
    written("schema = 1", folder="../..")
    assert find_project().file == Path("../..") / SETTINGS_FILE
    written("schema = 1")
    (sub / SETTINGS_FILE).mkdir()  # a folder is no file
    assert find_project().file == Path("..") / SETTINGS_FILE
    assert find_project().folders[:3] == (sub, sub.parent, tmp_path)


def test_every_key_is_read_and_paths_lead_from_the_file(written):
    assert read_settings(written(WHOLE)) == {
        "store": Path("../tables"),
        "vehicle": Path("../cars/car.toml"),
        "map": Path("/etc/map.toml"),
        "limits": Path("../../line.toml"),
        "station.name": "end of line 2",
        "station.golden": "car@1",
        "station.export": ["dcm", "json"],
        "keys.public": KEY,
        "require_signed": True,
        "by": "Ada Lovelace",
    }


@pytest.mark.parametrize(
    ("text", "key", "means"),
    [
        ('[station]\ngolden = "car@3"', "station.golden", "car@3"),
        ('[station]\ngolden = "./golden"', "station.golden", "../golden"),
        ('[station]\ngolden = "/x/v0001"', "station.golden", "/x/v0001"),
        *((f'[keys]\npublic = "{other}"', "keys.public", f"../{other}")
          for other in (KEY[:-1], KEY + "A", "R" + KEY[1:-1], KEY.lower())),
    ],
)  # fmt: skip
def test_golden_is_a_name_or_a_path_and_public_a_key_or_a_path(written, text, key, means):
    assert Path(read_settings(written(f"schema = 1\n{text}\n"))[key]) == Path(means)


def test_all_mistakes_are_one_error(written):
    path = written(
        'schema = 1\nstoer = "x"\nrequire_signed = "yes"\nby = "a\\nb"\nlimits = ""\n'
        '[station]\nexport = "dcm"\ngoldn = "a@1"\n[keys]\npublic = 3\n'
    )
    with pytest.raises(SettingsError) as refused:
        read_settings(path)
    message = str(refused.value)
    assert message.startswith(f"{path}: 7 errors")
    for part in (
        "did you mean 'store'",
        "did you mean 'golden'",
        "require_signed: 'yes'; expected true or false",
        "station.export: 'dcm'; expected a list",
        "limits: ''",
        "by: ",
        "keys.public",
    ):
        assert part in message
