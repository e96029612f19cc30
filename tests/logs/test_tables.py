"""Endings and the names of logs."""

from pathlib import Path

import pytest

from calib.logs.formats import TABLES, ending_of, stem_of


@pytest.mark.parametrize(
    ("name", "ending", "stem"),
    [
        ("ramp.csv", ".csv", "ramp"),
        ("ramp.csv.gz", ".csv.gz", "ramp"),
        ("ramp.2.CSV.GZ", ".csv.gz", "ramp.2"),
        ("ramp.v1.parquet", ".parquet", "ramp.v1"),
        ("RUN.VBO", ".vbo", "RUN"),
        ("ramp", "", "ramp"),
        ("ramp.gz", ".gz", "ramp"),
    ],
)
def test_ending_and_stem(name, ending, stem):
    path = Path("runs.2024") / name
    assert ending_of(path) == ending
    assert stem_of(path) == stem
    assert ending in TABLES or ending in ("", ".gz")
