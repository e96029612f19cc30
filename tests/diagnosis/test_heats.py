"""Thermal fade where no temperature is logged and the runs begin with discs of unlike heat."""

from dataclasses import replace

import numpy as np
import pytest

from calib.diagnosis.diagnose import diagnose
from calib.diagnosis.words import start_heats
from calib.physics.disc_temperature import DISCS, heated
from tests.support.hidden.cases import draw


def without_temperatures(logs):
    return [
        replace(log, channels={k: x for k, x in log.channels.items() if not k.startswith("T_disc")})
        for log in logs
    ]


@pytest.mark.slow
def test_fade_is_named_without_temperatures_and_the_hot_run_is_the_hot_one():
    case = draw("single", 12, names=("pad_thermal_fade",), severity=2)
    found = diagnose(
        case.vehicle, without_temperatures(case.calibration), without_temperatures(case.holdout)
    )
    assert [effect.name for effect in found.effects] == ["pad_thermal_fade"]
    assert found.groups == ()
    assert found.gap.closed > 0.9
    hot = max(case.calibration, key=lambda log: log["T_disc_f"][0])
    braked = {log.name for log in case.calibration if log["p_mc"].max() > 5e5}
    assert max(braked, key=lambda name: found.start_heats[name][0]) == hot.name
    assert hot.name in start_heats(found)


def test_a_disc_that_nothing_heats_cools_from_its_start():
    time = np.array([0.0, DISCS["f"].cooling_time])
    cooled = heated(time, np.zeros(2), DISCS["f"], 320.0)
    assert cooled[0] == pytest.approx(320.0)
    assert cooled[1] == pytest.approx(20.0 + 300.0 / np.e)
