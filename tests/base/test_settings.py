"""Where settings are found, and what their file may say."""

from pathlib import Path

import pytest

from calib.base.errors import SettingsError
from calib.base.settings import NAME, Settings
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
        path = Path(folder) / NAME
        path.write_text(text)
        return path

    return write


def test_the_nearest_file_counts(written, tmp_path):
    sub = tmp_path / "project" / "sub"
    assert find_project().file is None
    written("schema = 1", folder="../..")
    assert find_project().file == Path("../..") / NAME
    written("schema = 1")
    (sub / NAME).mkdir()  # a folder is no file
    assert find_project().file == Path("..") / NAME
    assert find_project().searched[:3] == (sub, sub.parent, tmp_path)


def test_every_key_is_read_and_paths_lead_from_the_file(written):
    assert read_settings(written(WHOLE)) == Settings(
        store=Path("../tables"),
        vehicle=Path("../cars/car.toml"),
        map=Path("/etc/map.toml"),
        limits=Path("../../line.toml"),
        station="end of line 2",
        golden="car@1",
        export=("dcm", "json"),
        public_key=KEY,
        require_signed=True,
        by="Ada Lovelace",
    )


@pytest.mark.parametrize(
    ("golden", "means"),
    [
        ("car@3", "car@3"),
        ("./golden", "../golden"),
        ("tables/car/v0001", "../tables/car/v0001"),
        ("/x/v0001", "/x/v0001"),
    ],
)
def test_a_golden_table_is_a_name_or_a_path(written, golden, means):
    path = written(f'schema = 1\n[station]\ngolden = "{golden}"\n')
    assert Path(read_settings(path).golden) == Path(means)


@pytest.mark.parametrize("other", [KEY[:-1], KEY + "A", "line.pub", "R" + KEY[1:-1], KEY.lower()])
def test_what_is_no_key_is_a_path(written, other):
    path = written(f'schema = 1\n[keys]\npublic = "{other}"\n')
    assert read_settings(path).public_key == Path("..") / other


def test_all_mistakes_are_one_error(written):
    path = written(
        'schema = 1\nstoer = "x"\nrequire_signed = "yes"\nby = "a\\nb"\nlimits = ""\n'
        '[station]\nexport = "dcm"\ngoldn = "a@1"\n[keys]\npublic = 3\n'
    )
    with pytest.raises(SettingsError) as refused:
        read_settings(path)
    message = str(refused.value)
    assert "7 errors" in message
    for part in (
        "did you mean 'store'",
        "did you mean 'golden'",
        "require_signed: 'yes'; expected true or false",
        "station.export: 'dcm'; expected a list",
        "limits: ''",
        "by: ",
        "keys.public",
        str(path),
    ):
        assert part in message
    assert refused.value.exit_code == 3
