"""What the doctor finds, on stores and packages that are made wrong on purpose."""

from importlib.metadata import requires, version

from calib.help import doctor
from calib.help.doctor import FINE, NOTE, WRONG, examine
from calib.store.store import Store
from tests.support.tables import made_table


def of(store, name):
    (found,) = [one for one in examine(store) if one.name == name]
    return found


def test_every_package_that_is_declared_is_told(tmp_path):
    told = {one.package: one for one in doctor.needs()}
    declared = [line for line in requires("brake-cal") if "extra" not in line]
    assert len(declared) >= 10
    for line in declared:
        name, _, lowest = line.partition(">=")
        assert (told[name].lowest, told[name].found) == (lowest, version(name))
    assert {one.extra for one in told.values()} == {"", "mdf", "can", "sign", "dist"}
    assert of(tmp_path, "numpy").state == FINE


def test_a_missing_package_is_wrong_and_a_missing_extra_is_not(tmp_path, monkeypatch):
    given = (doctor.Need("numpy", "2.0", "1.26"), doctor.Need("asammdf", "8.8", "", "mdf"))
    monkeypatch.setattr(doctor, "needs", lambda: given)
    assert of(tmp_path, "numpy").state == WRONG
    assert "1.26 (needs 2.0 or later)" in of(tmp_path, "numpy").what
    extra = of(tmp_path, "[mdf]")
    assert (extra.state, extra.do) == (NOTE, "if you need it: pip install 'brake-cal[mdf]'")


def test_the_store(tmp_path):
    store = tmp_path / "tables"
    assert (of(store, "store").state, "not there" in of(store, "store").what) == (NOTE, True)
    Store(store).save(made_table())
    assert of(store, "store").what == f"{store}: 1 version of 1 table"
    assert of(store, "store").state == FINE
    file = tmp_path / "file"
    file.touch()
    assert (of(file, "store").state, "is a file" in of(file, "store").what) == (WRONG, True)


def test_it_writes_nothing(tmp_path):
    examine(tmp_path / "tables")
    assert list(tmp_path.iterdir()) == []
