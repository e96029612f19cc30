import json
from dataclasses import replace

import pytest

from calib.car.effects.effects import Effects
from calib.exports.write import FORMATS
from calib.store.store import Store
from tests.support.tables import made_table


@pytest.mark.parametrize("form", FORMATS)
def test_every_format_is_written_and_names_its_table(tables, stored, tmp_path, form):
    out = tmp_path / "out"
    ran = tables("export", "sedan", "--format", form, "--out", out)
    assert ran.code == 0
    assert f"sedan@1 as {form}" in ran.out
    content = out.read_bytes()
    for part in ("sedan@1", stored.digest, "never extrapolated"):
        assert part.encode() in content
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out", "tables"]


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


def test_an_effect_that_no_ecu_senses_ends_with_4_until_it_is_named(brake_cal, tmp_path):
    fades = Effects({"pad_thermal_fade": {"fade_slope": 1e-3, "fade_onset": 150.0}})
    table = made_table()
    Store(tmp_path / "s").save(replace(table, vehicle=replace(table.vehicle, effects=fades)))
    words = ("tables", "export", "sedan", "--unreleased", "--store", tmp_path / "s")
    out = tmp_path / "car.dcm"
    assert brake_cal(*words, "--out", out).code == 4
    assert not out.exists()
    assert brake_cal(*words, "--out", out, "--without-effect", "pad_thermal_fade").code == 0
    assert brake_cal(*words, "--out", out, "--without-effect", "hydraulic_lag").code == 2
