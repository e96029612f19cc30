"""The limits file that `limits` writes has the default limits."""

from calib.estimation.limits_file import read_limits
from calib.estimation.metrics import METRICS as OF_STOPS
from calib.line.station.limits_file import LIMITS, limits_file
from calib.line.station.metrics import METRICS as OF_CAR


def test_it_reads_back_as_the_defaults(tmp_path):
    path = tmp_path / "line.toml"
    path.write_text(limits_file())
    assert read_limits(path, {*OF_CAR, *OF_STOPS}) == LIMITS
