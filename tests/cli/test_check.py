"""`brake-cal check`: one line for each log."""

from pathlib import Path

from calib.logs.write import write_csv
from tests.cli.conftest import parsed
from tests.support.made_runs import changed, made_run

SEDAN = Path(__file__).parents[2] / "sample_logs/sedan"


def test_a_log_is_usable_useless_or_unreadable(brake_cal, tmp_path, monkeypatch):
    monkeypatch.delenv("COLUMNS")
    write_csv(changed(made_run(), p_mc=None), tmp_path / "useless.csv")
    coast, useless, none = SEDAN / "coast.csv", tmp_path / "useless.csv", tmp_path / "none.csv"
    for logs, code in (((coast,), 0), ((coast, useless), 1), ((none, useless, coast), 3)):
        document = parsed(ran := brake_cal("check", *logs, "--json"))
        assert ran.code == code
        assert document["logs"][-1]["log"] in ("coast", "useless")
        assert len(document["logs"]) + len(document["unreadable"]) == len(logs)
        assert ("error" in document) == (code == 3)
        assert len(brake_cal("check", *logs).out.splitlines()) == len(document["logs"])
