"""What the doctor finds, on stores and packages that are made wrong on purpose."""

from packaging.requirements import Requirement

from calib.help import doctor
from calib.help.doctor import FINE, NOTE, WRONG, examine
from calib.store.store import Store
from tests.support.tables import made_table


def of(store, name):
    (finding,) = [one for one in examine(store) if one.name == name]
    return finding


def test_a_missing_package_is_wrong_and_a_missing_extra_is_not(tmp_path, monkeypatch):
    installed = ((Requirement("numpy>=2.0"), "1.26", ""), (Requirement("asammdf>=8.8"), "", "mdf"))
    monkeypatch.setattr(doctor, "packages", lambda: installed)
    assert of(tmp_path, "numpy").state == WRONG
    assert "1.26 (needs >=2.0)" in of(tmp_path, "numpy").text
    extra = of(tmp_path, "asammdf [mdf]")
    assert extra.state == NOTE
    assert extra.do.endswith("pip install 'brake-cal[mdf]'")


def test_the_store(tmp_path):
    store = tmp_path / "tables"
    assert (of(store, "store").state, "not there" in of(store, "store").text) == (NOTE, True)
    Store(store).save(made_table())
    assert of(store, "store").text == f"{store}: 1 version of 1 table"
    assert of(store, "store").state == FINE
    file = tmp_path / "file"
    file.touch()
    assert (of(file, "store").state, "is a file" in of(file, "store").text) == (WRONG, True)
