"""What the doctor finds, on stores and packages that are made wrong on purpose."""

from packaging.requirements import Requirement

from calib.help import doctor
from calib.help.doctor import FINE, NOTE, WRONG, examine
from calib.store.store import Store
from tests.support.tables import made_table


def finding_of(store, name):
    (finding,) = [finding for finding in examine(store) if finding.name == name]
    return finding


def test_a_missing_package_is_wrong_and_a_missing_extra_is_not(tmp_path, monkeypatch):
    installed = ((Requirement("numpy>=2.0"), "1.26", ""), (Requirement("asammdf>=8.8"), "", "mdf"))
    monkeypatch.setattr(doctor, "packages", lambda: installed)
    assert finding_of(tmp_path, "numpy").state == WRONG
    assert "1.26 (needs >=2.0)" in finding_of(tmp_path, "numpy").text
    extra = finding_of(tmp_path, "asammdf [mdf]")
    assert extra.state == NOTE
    assert extra.do.endswith("pip install 'brake-cal[mdf]'")


def test_a_store_can_be_missing_or_fine_or_a_file(tmp_path):
    store = tmp_path / "tables"
    finding = finding_of(store, "store")
    assert (finding.state, "not there" in finding.text) == (NOTE, True)
    Store(store).save(made_table())
    finding = finding_of(store, "store")
    assert (finding.state, finding.text) == (FINE, f"{store}: 1 version of 1 table")
    file = tmp_path / "file"
    file.touch()
    finding = finding_of(file, "store")
    assert (finding.state, "is a file" in finding.text) == (WRONG, True)
