"""Noise-free 40 Hz logs without an unbraked part are diagnosed too, of a plant of tests/."""

import pytest

from calib.diagnosis.diagnose import diagnose
from calib.logs.log import Log
from tests.support.plant import Plant, as_log, drive
from tests.support.reference_car import CAR, IDEAL, REAL
from tests.support.refusals import why_not


def braked(plant: Plant, name: str, pressure: float, rise: float, v0: float) -> Log:
    """Braked from 0.5 s on: shorter than any part from which noise can be taken."""

    def pressed(t: float) -> float:
        return pressure * min(max((t - 0.5) / rise, 0.0), 1.0)

    return as_log(drive(plant, pressed, v0, duration=6.0, rate=40.0, stop_speed=2.0), name)


def logs(plant: Plant) -> tuple[list[Log], list[Log]]:
    calibration = [
        braked(plant, "ramp", 40e5, 5.0, 33.0),
        braked(plant, "light", 12e5, 0.3, 30.0),
        braked(plant, "hard", 35e5, 0.3, 30.0),
    ]
    return calibration, [braked(plant, "held", 20e5, 0.3, 28.0)]


def test_a_car_that_lacks_nothing_has_no_gap():
    calibration, holdout = logs(IDEAL)
    assert all(why_not(log, "diagnose") == [] for log in (*calibration, *holdout))
    diagnosis = diagnose(CAR, calibration, holdout)
    assert (diagnosis.verdict, diagnosis.effects) == ("no_gap", ())
    assert diagnosis.model_after == diagnosis.model_before
    assert diagnosis.gap.noise.min() >= 0.003


@pytest.mark.slow
def test_three_effects_of_a_real_car_are_named_with_their_sizes():
    """Three short stops: a slope or an engine is like some of it, so others may be as likely."""
    diagnosis = diagnose(CAR, *logs(REAL))
    values = {name: p.value for e in diagnosis.effects for name, p in e.parameters.items()}
    assert values == {
        "drag_area": pytest.approx(0.66, rel=0.05),
        "load_share": pytest.approx(1.0, abs=0.1),
        "coefficient": pytest.approx(0.011, rel=0.05),
        "rolling_growth": pytest.approx(0.0, abs=0.01),
        "radius_mismatch": pytest.approx(0.0008, rel=0.05),
    }
    assert diagnosis.unexplained is None
    assert diagnosis.gap.closed > 0.9
