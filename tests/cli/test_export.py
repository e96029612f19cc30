import json

import pytest

from tests.support.tables import made_table


@pytest.mark.parametrize(
    "arguments",
    [
        ("--format", "dmc", "--out", "a"),
        ("--format", "dcm", "--out", "a", "--fixed-point", "16"),
        ("--format", "c-header", "--out", "a", "--fixed-point", "12"),
        ("--format", "c-header", "--out", "a", "--elf", "ecu.elf"),
        ("--format", "csv", "--out", "a", "--float"),
        ("--format", "c-header", "--out", "a", "--float", "--fixed-point", "16"),
        ("--format", "a2l", "--out", "a", "--elf", "a"),
        ("--format", "dcm", "--out", "a", "--points", "22"),
        ("--out", "a"),
    ],
)
def test_usage_errors_end_with_2_and_write_nothing(tables, tmp_path, monkeypatch, arguments):
    monkeypatch.chdir(tmp_path)
    ran = tables("export", "sedan", *arguments)
    assert (ran.code, ran.result) == (2, "")
    assert [p.name for p in tmp_path.iterdir()] == ["tables"]


def test_a_verdict_becomes_the_state(tables, tmp_path):
    summary = tmp_path / "summary.json"
    logs = [{"log": "stop", "role": "hold-out", "verdict": "passed"}]
    document = {"schema": 1, "table": "sedan@1", "digest": made_table().digest, "logs": logs}
    document |= {"verdict": "passed", "proof": "truth"}
    summary.write_text(json.dumps(document))
    out = tmp_path / "a.cdfx"
    tables("export", "sedan", "--format", "cdfx", "--out", out, "--validation", summary)
    assert "<STATE>checked</STATE>" in out.read_text()
    summary.write_text(json.dumps({**document, "table": "wagon@1"}))
    ran = tables("export", "sedan", "--format", "csv", "--out", tmp_path / "b", "--validation",
                 summary)  # fmt: skip
    assert ran.code == 3
    assert "is of wagon@1" in ran.err
    assert not (tmp_path / "b").exists()
