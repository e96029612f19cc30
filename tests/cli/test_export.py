import hashlib
import json
import re
import subprocess
from dataclasses import replace

import pytest

from calib.car.effects.effects import Effects
from calib.exports.write import FORMATS
from calib.store.store import Store
from tests.support.programs import linked, made_elf, needs_gcc
from tests.support.tables import made_table


@pytest.mark.parametrize("form", FORMATS)
def test_every_format_is_written_and_names_its_table(tables, stored, tmp_path, form):
    out = tmp_path / "out"
    ran = tables("export", "sedan", "--format", form, "--out", out)
    assert ran.code == 0
    assert f"sedan@1 as {form}" in ran.out
    content = out.read_bytes()
    for part in ("sedan@1", stored.digest, "clamped, never extrapolated"):
        assert part.encode() in content
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out", "tables"]


def test_json_says_what_was_written_and_what_it_costs(tables, stored, tmp_path):
    out = tmp_path / "s.h"
    ran = tables("export", "sedan", "--format", "c-header", "--out", out, "--points", "5",
                 "--fixed-point", "16", "--json")  # fmt: skip
    document = json.loads(ran.out)
    assert (document["table"], document["digest"]) == ("sedan@1", stored.digest)
    assert document["sha256"] == hashlib.sha256(out.read_bytes()).hexdigest()
    eta = document["axes"][0]
    assert (eta["label"], eta["points"], eta["rows"]) == ("sedan_eta", 5, 21)
    # f1 = D (l_f - K (eta - 1) h)/L is a parabola. Over five steps of 0.00025 a chord is at most
    # 2*3 steps^2 times C K h/L off, at the second and the third row.
    assert eta["worst"] == pytest.approx(6 * 0.00025**2 * 27 * 60 * 0.615 / 2.805, rel=1e-6)
    assert 0 < eta["rms"] < eta["worst"]
    assert document["fixed_point"]["bits"] == 16
    errors = {r["label"]: r for r in document["fixed_point"]["objects"]}
    assert errors["sedan_eta"]["error"] <= errors["sedan_eta"]["step"] / 2


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


@needs_gcc
def test_an_a2l_takes_its_addresses_from_the_program_of_the_header(tables, tmp_path):
    out, header = tmp_path / "a.a2l", tmp_path / "a.h"
    way = ("--points", "8", "--fixed-point", "16", "--out")
    assert tables("export", "sedan", "--format", "c-header", *way, header).code == 0
    elf = linked(tmp_path, header.read_bytes(), "sedan")
    ran = tables("export", "sedan", "--format", "a2l", "--elf", elf, *way, out)
    assert (ran.code, "address" in ran.err) == (0, False)
    printed = subprocess.run(["nm", elf], capture_output=True, text=True, check=True).stdout
    address = re.search(r"^0*([0-9a-f]+) R sedan_f1$", printed, re.MULTILINE)[1]
    assert f"CURVE 0x{int(address, 16):08X} " in out.read_text()


def test_a_program_that_does_not_fit_ends_with_3_and_writes_nothing(tables, tmp_path):
    elf = tmp_path / "ecu.elf"
    elf.write_bytes(made_elf({"_start": bytes(8)}, "<", True))
    way = ("export", "sedan", "--format", "a2l", "--out", tmp_path / "a", "--elf")
    ran = tables(*way, elf)
    assert (ran.code, ran.result) == (3, "")
    assert "has no symbol sedan_eta" in ran.err
    assert "SEDAN_DEFINE" in ran.err
    assert not (tmp_path / "a").exists()


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
