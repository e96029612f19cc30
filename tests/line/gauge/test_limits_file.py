import pytest

from calib.base.errors import LimitsError
from calib.line.gauge.limits_file import read_gauge_limits
from calib.line.gauge.study import DEFAULTS


def test_without_a_file_the_usual_limits_hold():
    assert read_gauge_limits(None) == DEFAULTS


@pytest.mark.parametrize("ends", ["min = 0.8", "max = 1.2", "min = 1.0, max = 1.0"])
def test_a_tolerance_has_two_ends_and_the_error_names_the_file(tmp_path, ends):
    path = tmp_path / "gauge.toml"
    path.write_text(f"schema = 1\n[limits]\npad_scale = {{ {ends} }}\n")
    with pytest.raises(LimitsError, match=r"gauge\.toml.*pad_scale.*needs two ends"):
        read_gauge_limits(path)
