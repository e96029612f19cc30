import pytest


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
