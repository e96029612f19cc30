import pytest

from calib.base.errors import InputError
from calib.help import samples


def test_the_sample_logs_are_there_with_their_vehicle():
    place = samples.sample_logs()
    assert (place / "sedan" / "vehicle.toml").is_file()
    assert list(place.glob("sedan/ramp*.csv"))


def test_installed_logs_come_before_those_of_a_checkout(tmp_path, monkeypatch):
    monkeypatch.setattr(samples, "__file__", str(tmp_path / "calib" / "demo" / "samples.py"))
    with pytest.raises(InputError, match="not installed"):
        samples.sample_logs()
    (tmp_path / "sample_logs").mkdir()
    assert samples.sample_logs() == tmp_path / "sample_logs"
    installed = tmp_path / "calib" / "demo" / "sample_logs"
    installed.mkdir(parents=True)
    assert samples.sample_logs() == installed
