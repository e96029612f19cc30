"""`brake-cal tables list`."""

from calib.store.store import Store


def test_list_names_every_version(tables, two, document):
    ran = tables("list")
    assert ran.code == 0
    assert [line.split()[0] for line in ran.out.splitlines()[1:]] == [
        "sedan@1",
        "sedan@2",
        "wagon@1",
    ]
    rows = document(tables("list", "--json"))["tables"]
    assert [row["id"] for row in rows] == ["sedan@1", "sedan@2", "wagon@1"]
    assert rows[1]["digest"] == Store(two).load("sedan").digest
    assert rows[0]["logs"] == ["ramp.csv", "coast.csv"]


def test_list_of_an_empty_store_says_so(brake_cal, tmp_path, document):
    ran = brake_cal("tables", "list", "--store", tmp_path)
    assert (ran.code, ran.out) == (0, f"{tmp_path} holds no table\n")
    ran = brake_cal("tables", "list", "--store", tmp_path, "--json")
    assert document(ran) == {"schema": 1, "store": str(tmp_path), "tables": []}


def test_the_store_is_tables_unless_told_otherwise(brake_cal, two, monkeypatch):
    monkeypatch.chdir(two.parent)
    assert "wagon@1" in brake_cal("tables", "list").out


def test_without_a_store_it_ends_with_2(brake_cal, tmp_path):
    ran = brake_cal("tables", "list", "--store", tmp_path / "none", "--json")
    assert (ran.code, ran.result) == (2, "")
    assert "no table store here" in ran.err
