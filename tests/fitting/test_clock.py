"""Pads do not hang on the digits of the clock: times in whole milliseconds against full times."""

from dataclasses import replace

import numpy as np
import pytest

from calib.fitting.fit import fit
from calib.logs.read import read_log
from calib.logs.write import write_csv
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, noisy


def test_whole_milliseconds_move_no_pad(tmp_path):
    run = drive(REAL, lambda t: 8e5 * max(t - 1.5, 0.0), 33.0, duration=7.0, rate=300.0)
    true = noisy(as_log(run, "ramp"), 1)
    rounded = replace(true, channels={**true.channels, "time": np.round(true.time, 3)})
    write_csv(rounded, tmp_path / "ramp.csv")
    read = read_log(tmp_path / "ramp.csv")
    assert len(read.notes) == 1
    pads = [fit(CAR, [log]).calibration for log in (true, read)]
    for axle in ("pad_friction_f", "pad_friction_r"):
        full, found = (getattr(one, axle).value for one in pads)
        assert found == pytest.approx(full, rel=0.005)
