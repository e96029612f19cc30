"""The file that `limits` writes says what the program does."""

from calib.estimation.limits_file import read_limits
from calib.estimation.metrics import METRICS as OF_STOPS
from calib.line.station.limits_file import LIMITS, document, limits_file
from calib.line.station.metrics import METRICS as OF_CAR


def test_it_reads_back_as_the_defaults(tmp_path):
    path = tmp_path / "line.toml"
    path.write_text(limits_file())
    assert read_limits(path, {*OF_CAR, *OF_STOPS}) == LIMITS


def test_every_limit_has_its_meaning_and_reason_above_it():
    lines = limits_file().splitlines()
    for row in document():
        figure = row["limit"].figure
        i = next(i for i, line in enumerate(lines) if line.startswith(f"{figure} = "))
        assert lines[i - 1] == f"# why: {row['reason']}"
        assert {**OF_STOPS, **OF_CAR}[figure] in lines[i - 2]
