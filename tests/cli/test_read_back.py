import json

import pytest

from calib.store.store import Store
from tests.support.tables import made_table


@pytest.fixture
def exported(tables, stored, tmp_path):
    """Write the stored table in a format; returns the file."""

    def write(form, *more):
        out = tmp_path / "a"
        assert tables("export", stored.name, "--format", form, "--out", out, *more).code == 0
        return out

    return write


@pytest.mark.parametrize("form", ["dcm", "cdfx"])
@pytest.mark.parametrize("points", [(), ("--points", "6")])
def test_import_says_what_is_in_it_and_that_it_agrees(tables, exported, form, points):
    out = exported(form, *points)
    ran = tables("import", out)
    assert (ran.code, ran.err) == (0, "")
    assert "agrees with sedan@1 to the last bit" in ran.out
    assert "sedan_f1" in ran.out
    document = json.loads(tables("import", out, "--json").out)
    assert (document["in_store"], document["unchanged"], document["differences"]) == (
        True,
        True,
        [],
    )
    assert document["scalars"]["sedan_mass"] == 1744.0
    assert len(document["curves"]["sedan_f1"]["x"]) == (6 if points else 21)


def test_import_without_the_table_says_so(brake_cal, exported, tmp_path):
    out = exported("dcm")
    ran = brake_cal("tables", "import", out, "--store", tmp_path / "none")
    assert ran.code == 0
    assert "sedan@1 is not in this store" in ran.out


@pytest.mark.parametrize("form", ["dcm", "cdfx"])
def test_a_changed_number_ends_with_4_and_is_named(tables, exported, form):
    out = exported(form)
    out.write_text(out.read_text().replace("1744.0", "1745.0"))
    ran = tables("import", out)
    assert ran.code == 4
    assert "sedan_mass: 1745.0, the table has 1744.0" in ran.out
    assert "do not agree with its checksum" in ran.err
    ran = tables("import", out, "--json")
    assert ran.code == 4
    assert json.loads(ran.out)["unchanged"] is False


def test_the_digest_of_another_table_ends_with_4(brake_cal, exported, tmp_path):
    out = exported("dcm")
    Store(tmp_path / "other").save(made_table(28.0))
    ran = brake_cal("tables", "import", out, "--store", tmp_path / "other")
    assert ran.code == 4
    assert "claims digest" in ran.err


@pytest.mark.parametrize("form", ["dcm", "cdfx"])
def test_half_a_file_ends_with_3(tables, exported, form):
    out = exported(form)
    out.write_bytes(out.read_bytes()[: out.stat().st_size // 2])
    ran = tables("import", out)
    assert (ran.code, ran.result) == (3, "")
    assert "has no END" in ran.err or "cut off" in ran.err


def test_a_file_that_is_not_there_ends_with_3(tables, tmp_path):
    ran = tables("import", tmp_path / "none.dcm")
    assert (ran.code, ran.result) == (3, "")
    assert "no such file" in ran.err
