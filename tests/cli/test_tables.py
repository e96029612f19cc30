import json

import pytest

from calib.table.store import Store
from tests.support.tables import C, made_table


@pytest.fixture
def two(store):
    """A store with sedan@1, sedan@2 of another stiffness, and wagon@1."""
    Store(store).save(made_table())
    Store(store).save(made_table(28.0))
    Store(store).save(made_table(name="wagon"))
    return store


@pytest.fixture
def tables(brake_cal, two):
    def run(*arguments):
        return brake_cal("tables", *arguments, "--store", two)

    return run


def document(ran):
    """The one JSON document on stdout, of a command that said nothing else."""
    assert ran.err == ""
    return json.loads(ran.out)


def test_list_names_every_version(tables, two):
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


def test_list_of_an_empty_store_says_so(brake_cal, tmp_path):
    ran = brake_cal("tables", "list", "--store", tmp_path)
    assert (ran.code, ran.out) == (0, f"{tmp_path} holds no table\n")
    ran = brake_cal("tables", "list", "--store", tmp_path, "--json")
    assert document(ran) == {"store": str(tmp_path), "tables": []}


def test_the_store_is_tables_unless_told_otherwise(brake_cal, two, monkeypatch):
    monkeypatch.chdir(two.parent)
    assert "wagon@1" in brake_cal("tables", "list").out


def test_without_a_store_it_ends_with_4(brake_cal, tmp_path):
    ran = brake_cal("tables", "list", "--store", tmp_path / "none", "--json")
    assert (ran.code, ran.out) == (4, "")
    assert "no table store here" in ran.err


def test_show_prints_what_an_engineer_asks_for(tables, two):
    ran = tables("show", "sedan@1")
    assert ran.code == 0
    for part in (
        "sedan@1",
        Store(two).load("sedan@1").digest,
        "sedan, 1744 kg",
        "ramp.csv (abababababab)",
        "drag_area 0.66 (95 %: 0.6208 to 0.6992) m^2",
        "1.05 (95 %: 1.03 to 1.07)",
        "0.000 to 0.300 g",
        f"eta 1.00500, D {C * 0.005:.4f}",
        "rms",
        "made from a closed form",
    ):
        assert part in ran.out
    # The last row: z = 0.3, D = 0.135, rear share (1.1556 - 0.3*0.615)/2.805 = 0.3462.
    assert "1.00500  0.300  +0.0467  -0.0883" in ran.out


def test_show_json_holds_the_whole_table(tables):
    shown = document(tables("show", "sedan@1", "--json"))
    record, curves = made_table().content()
    assert shown["id"] == "sedan@1"
    assert shown["digest"] == made_table().digest
    assert shown["record"] == record
    assert shown["curves"]["paper"]["f1"] == curves["paper"]["f1"].tolist()
    assert shown["peak"] == pytest.approx({"eta": 1.005, "D": C * 0.005})


def test_show_of_an_unknown_table_ends_with_4(tables):
    ran = tables("show", "sedna", "--json")
    assert (ran.code, ran.out) == (4, "")
    assert "did you mean 'sedan'" in ran.err


def test_diff_gives_the_gap_of_the_curves(tables):
    difference = document(tables("diff", "sedan@1", "sedan", "--json"))
    D = next(gap for gap in difference["curves"] if gap["curve"] == "D")
    assert D["largest"] == pytest.approx((28.0 - C) * 0.005)
    assert (difference["a"], difference["b"], difference["identical"]) == (
        "sedan@1",
        "sedan@2",
        False,
    )
    ran = tables("diff", "sedan@1", "sedan")
    assert ran.code == 0
    assert "+0.00500" in ran.out


def test_diff_names_changed_keys(tables):
    ran = tables("diff", "sedan@1", "wagon")
    assert '"sedan"' in ran.out
    assert '"wagon"' in ran.out


def test_diff_of_the_same_says_so(tables):
    assert tables("diff", "sedan@1", "sedan@1").out == "sedan@1 and sedan@1 hold the same\n"


def test_verify_passes_a_sound_store(tables):
    ran = tables("verify", "--json")
    assert ran.code == 0
    assert document(ran)["sound"] is True
    assert [v["id"] for v in document(tables("verify", "wagon", "--json"))["versions"]] == [
        "wagon@1"
    ]


def test_verify_ends_with_4_and_says_where(tables, two):
    path = two / "sedan" / "v0001" / "paper.parquet"
    path.write_bytes(path.read_bytes()[:-1])
    ran = tables("verify", "--json")
    assert ran.code == 4
    verdicts = document(ran)["versions"]
    assert [v["sound"] for v in verdicts] == [False, True, True]
    assert "paper.parquet" in verdicts[0]["violations"][0]
    ran = tables("verify")
    assert ran.code == 4
    assert "paper.parquet" in ran.out
    assert tables("verify", "wagon").code == 0


def test_show_of_a_damaged_table_ends_with_4(tables, two):
    (two / "wagon" / "v0001" / "tyre.parquet").unlink()
    ran = tables("show", "wagon")
    assert (ran.code, ran.out) == (4, "")
    assert "tyre.parquet: missing" in ran.err
