"""`brake-cal tables show`."""

import pytest

from calib.store.store import Store
from tests.support.tables import C, made_table


def test_show_prints_what_an_engineer_asks_for(tables, two):
    ran = tables("show", "sedan@1")
    assert ran.code == 0
    for part in (
        "sedan@1",
        Store(two).load("sedan@1").digest,
        "sedan, 1744 kg",
        "ramp.csv (abababababab)",
        "drag_area 0.66 m^2 (95 %: 0.6208 to 0.6992)",
        "1.05 (95 %: 1.03 to 1.07)",
        "0.000 to 0.285 g",
        f"eta 1.00500, D {C * 0.005:.4f}",
        "rms",
        "made from a closed form",
    ):
        assert part in ran.out
    # The last row: z = 0.3, D = 0.135, rear share (1.1556 - 0.3*0.615)/2.805 = 0.3462.
    assert "1.00500  0.300  +0.0467  -0.0883" in ran.out


def test_show_json_holds_the_whole_table(tables, two, document):
    shown = document(tables("show", "sedan@1", "--json"))
    record, curves = made_table().content()
    assert shown["id"] == "sedan@1"
    assert shown["digest"] == made_table().digest
    assert shown["record"] == record
    assert shown["curves"]["paper"]["f1"] == curves["paper"]["f1"].tolist()
    assert shown["peak"] == pytest.approx({"eta": 1.005, "D": C * 0.005})


def test_show_of_an_unknown_table_ends_with_2(tables, two):
    ran = tables("show", "sedna")
    assert (ran.code, ran.result) == (2, "")
    assert "did you mean 'sedan'" in ran.err


def test_show_of_a_damaged_table_ends_with_4(tables, two):
    (two / "wagon" / "v0001" / "tyre.parquet").unlink()
    ran = tables("show", "wagon")
    assert (ran.code, ran.result) == (4, "")
    assert "tyre.parquet: missing" in ran.err
