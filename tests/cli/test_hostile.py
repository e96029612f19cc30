"""Files made to break a reader end with one line and the right exit code, and leave nothing."""

import pytest

from tests.support.hostile import CASES, RAW


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_it_is_told_in_one_line(case, brake_cal, tmp_path, monkeypatch):
    words = case.make(tmp_path)
    before = sorted(tmp_path.iterdir())
    monkeypatch.chdir(tmp_path)
    ran = brake_cal(*words)
    assert ran.code == case.code, ran.err
    assert not RAW.search(ran.out + ran.err)
    if case.code == 3:
        assert ran.err.count("error: ") == 1
        assert len(ran.err.partition("error: ")[2].splitlines()) == 1
    assert sorted(tmp_path.iterdir()) == before


def test_one_broken_record_is_a_line_of_the_list(brake_cal, tmp_path, monkeypatch):
    case = next(case for case in CASES if case.name == "record of 100,000 [, list")
    words = case.make(tmp_path)
    monkeypatch.chdir(tmp_path)
    out = brake_cal(*words).out
    assert "sedan-2up@1 cannot be used" in out
    for table in ("escort@1", "sedan-2up@2", "sedan-sim@1"):
        (line,) = [line for line in out.splitlines() if line.startswith(table)]
        assert "released" in line or "draft" in line
