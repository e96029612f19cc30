"""Effects of the catalogue hidden in the plant, whose forms differ from those of the cards."""

from dataclasses import replace

import pytest

from calib.diagnosis.diagnose import Diagnosis, diagnose
from tests.support.hidden import manoeuvres
from tests.support.hidden.cases import HiddenCase, draw

pytestmark = pytest.mark.slow


def answer(case: HiddenCase) -> Diagnosis:
    return diagnose(case.vehicle, list(case.calibration), list(case.holdout))


@pytest.fixture(scope="module")
def play() -> HiddenCase:
    """A play of fixed width: seed 1 draws that one of the two."""
    case = draw("single", 1, names=("caliper_hysteresis",), severity=2)
    assert case.hidden.hysteresis_fixed > 0.0
    return case


def test_a_play_of_fixed_width_is_named_and_told_as_fixed(play):
    found = answer(play)
    assert found.verdict == "named"
    (effect,) = found.effects
    assert effect.name == "caliper_hysteresis"
    low, high = effect.parameters["width"].ci95
    assert low < 2.0 * play.hidden.hysteresis_fixed / 20e5 < high
    assert effect.parameters["fixed_share"].value > 0.7
    assert found.gap.closed > 0.85


def test_fade_is_named_without_a_log_of_temperature_where_all_runs_begin_alike(monkeypatch):
    """The plant's discs take more heat than the assumed ones, so the slope is not comparable."""
    for run in manoeuvres.TEMPERATURE:
        monkeypatch.setitem(manoeuvres.TEMPERATURE, run, 150.0)
    case = draw("single", 41, names=("pad_thermal_fade",), severity=2)
    calibration, holdout = (
        [
            replace(log, channels={k: v for k, v in log.channels.items() if "T_disc" not in k})
            for log in logs
        ]
        for logs in (case.calibration, case.holdout)
    )
    found = diagnose(case.vehicle, calibration, holdout)
    assert [effect.name for effect in found.effects] == ["pad_thermal_fade"]
    assert found.gap.closed > 0.7


def test_anti_dive_is_the_elastic_share_of_the_pitch():
    """The links carry the rest of the load transfer at once: no effect with a name of its own."""
    case = draw("single", 88101, names=("anti_dive",), severity=1)
    found = answer(case)
    assert [effect.name for effect in found.effects] == ["pitch_coupling"]
    low, high = found.effects[0].parameters["elastic_share"].ci95
    assert low < case.hidden.through_springs < high < 1.0
