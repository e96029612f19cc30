"""Thermal fade where no temperature is logged and the runs begin with discs of unlike heat."""

from dataclasses import replace

import numpy as np
import pytest

import calib
from calib.car.disc_temperature import DISCS, heated
from calib.car.effects.effects import Effects
from calib.diagnosis.explanation.fit import fit
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import problem_of
from calib.diagnosis.search.decide import Decision
from calib.diagnosis.search.heats import start_heats_of, with_start_heats
from calib.model.sensor_noise import add_noise
from tests.support.effect_runs import SEDAN
from tests.support.explained import diagnosed
from tests.support.hidden.cases import draw
from tests.support.reference_car import without


@pytest.mark.slow
def test_fade_is_named_without_temperatures_and_the_hot_run_is_the_hot_one():
    case = draw("single", 12, names=("pad_thermal_fade",), severity=2)
    logs, held = (
        tuple(without(log, "T_disc_f", "T_disc_r") for log in part)
        for part in (case.calibration, case.holdout)
    )
    found = diagnosed(replace(case, calibration=logs, holdout=held))
    assert [effect.name for effect in found.effects] == ["pad_thermal_fade"]
    assert found.groups == ()
    assert found.gap.closed > 0.9
    hot = max(case.calibration, key=lambda log: log["T_disc_f"][0])
    braked = {log.name for log in case.calibration if log["p_mc"].max() > 5e5}
    assert max(braked, key=lambda name: found.start_heats[name][0]) == hot.name


def test_front_and_rear_discs_that_begin_unlike_are_found_with_the_fade():
    """Heats and onset count from each other alone, so what is above the onset is compared."""
    fade = {"fade_slope": 0.0012, "fade_onset": 150.0}
    effects = Effects({"pad_thermal_fade": fade})
    model = replace(calib.default_model(SEDAN), effects=effects)
    time = np.arange(0.0, 9.0, 0.005)
    heats = {(60.0, 60.0): 18, (300.0, 140.0): 22, (180.0, 260.0): 26, (380.0, 240.0): 34}
    logs = []
    for heat, pressure in heats.items():
        p = np.clip(20e5 * (time - 1.5), 0.0, 1e5 * pressure)
        log = calib.simulate(model, time, p, 35.0, start_heat=heat, name=f"at {pressure} bar")
        logs.append(add_noise(log, pressure))
    problem = problem_of(SEDAN, [run_of(log) for log in logs])
    base = fit(problem, (), problem.start)
    found = with_start_heats(Decision("unknown", base, base, ()))
    assert (found.verdict, found.best.names) == ("named", ("pad_thermal_fade",))
    told = found.best.effects.parameters["pad_thermal_fade"]
    assert told["fade_slope"] == pytest.approx(0.0012, rel=0.05)
    above = np.array(list(start_heats_of(found.best.problem.runs).values())) - told["fade_onset"]
    hot = np.array(list(heats))[1:] - 150.0
    assert above[1:] == pytest.approx(hot, abs=25.0)


def test_a_disc_that_nothing_heats_cools_from_its_start():
    time = np.array([0.0, DISCS["f"].cooling_time])
    cooled = heated(time, np.zeros(2), DISCS["f"], 320.0)
    assert cooled[0] == pytest.approx(320.0)
    assert cooled[1] == pytest.approx(20.0 + 300.0 / np.e)
