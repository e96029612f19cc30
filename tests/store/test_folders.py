"""What a store refuses of names, links and line ends, before anything is written."""

import pytest

from calib.base.errors import DamagedTable, StoreError, VehicleError
from calib.car.vehicle_file import read_vehicle
from calib.store.store import Store
from tests.support.reference_car import SEDAN
from tests.support.tables import made_table


@pytest.fixture
def store(tmp_path):
    tables = Store(tmp_path / "tables")
    tables.save(made_table())
    return tables


@pytest.mark.parametrize(
    "name",
    [
        *("a b", "-rf", "journal.jsonl", "Journal.head", "a..b", "x" * 101, "", "a@1", "a\n"),
        *("..", "../evil", "a/b", "/tmp/x", ".hidden"),
        *("CON", "nul", "com1.car", "Lpt9", "car."),  # which Windows cannot store
    ],
)
def test_a_vehicle_that_names_no_table_is_refused_as_it_is_read(tmp_path, name):
    path = tmp_path / "car.toml"
    text = (SEDAN / "vehicle.toml").read_text()
    path.write_text(text.replace('name = "sedan-2up"', f'name = "{name}"'))
    with pytest.raises(VehicleError):
        read_vehicle(path)
    with pytest.raises(StoreError):
        Store(tmp_path / "tables").save(made_table(name=name))
    assert not (tmp_path / "tables").exists()


def test_nothing_is_written_through_a_folder_that_is_a_link(store, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    (store.folder / "sedan").rename(elsewhere)
    (store.folder / "sedan").symlink_to(elsewhere)
    paths = sorted(elsewhere.rglob("*"))
    with pytest.raises(StoreError) as error:
        store.save(made_table(28.0))
    assert str(error.value.where).endswith("sedan")
    assert sorted(elsewhere.rglob("*")) == paths


def test_a_link_in_the_place_of_a_begun_version_is_cleared(store, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "kept").write_text("")
    (store.folder / "sedan" / ".new-v0002").symlink_to(elsewhere)
    assert store.save(made_table(28.0)).id == "sedan@2"
    assert (elsewhere / "kept").exists()


@pytest.mark.parametrize("name", ["journal.jsonl", "sedan/v0001/record.json"])
def test_line_ends_that_git_changed_are_named(store, name):
    assert (store.folder / ".gitattributes").read_text() == "* -text\n"
    path = store.folder / name
    path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
    with pytest.raises(DamagedTable) as error:
        store.load("sedan@1")
    assert "CRLF" in error.value.problem


def test_a_listing_reads_only_the_states_that_are_asked_for(store, monkeypatch):
    read = []
    monkeypatch.setattr(
        "calib.store.snapshot.read_version", lambda *words: read.append(words) or 1 / 0
    )
    assert list(store.entries("released")) == []
    assert read == []


def test_a_name_that_differs_in_case_alone_is_refused(store):
    paths = sorted(store.folder.rglob("*"))
    with pytest.raises(StoreError):
        store.save(made_table(name="Sedan"))
    assert sorted(store.folder.rglob("*")) == paths
    assert store.save(made_table(28.0)).id == "sedan@2"
