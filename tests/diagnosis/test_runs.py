"""Mistakes of the people who record logs are refused before the search; hidden effects are not."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.diagnosis import runs
from calib.diagnosis.diagnose import diagnose
from calib.logs.log import Log
from tests.support.explained import diagnosed
from tests.support.hidden.cases import HiddenCase, draw
from tests.support.reference_car import swapped


@pytest.fixture(scope="module")
def late() -> HiddenCase:
    """A car whose brakes lag: the pressure does not go with the deceleration at once."""
    return draw("single", 21, names=("hydraulic_lag",), severity=2, only=FIVE)


FIVE = ("coast", "ramp", "hot", "release", "hot_stop")


def changed(log: Log, **channels: np.ndarray) -> Log:
    return replace(log, channels=log.channels | channels, digest=f"{log.digest} changed")


def refused(case: HiddenCase, logs: list[Log], holdout: list[Log] | None = None) -> str:
    with pytest.raises(LogError) as error:
        runs.checked(case.vehicle, logs, list(case.holdout) if holdout is None else holdout)
    return str(error.value)


def with_(case: HiddenCase, name: str, change) -> list[Log]:
    assert name in [log.name for log in case.calibration]
    return [change(log) if log.name == name else log for log in case.calibration]


def named(case: HiddenCase, name: str) -> Log:
    return next(log for log in (*case.calibration, *case.holdout) if log.name == name)


def test_a_copy_of_a_calibration_log_is_no_hold_out(late):
    ramp = named(late, "ramp")
    copy = Log("mine", "mine.parquet", "", {n: x[200:] for n, x in ramp.channels.items()})
    message = refused(late, list(late.calibration), [*late.holdout, copy])
    assert message.startswith(f"mine.parquet: the same run as {ramp.source}")
    assert "no hold-out and proves nothing" in message
    assert "given twice" in refused(late, [*late.calibration, copy])
    twice = [*late.holdout, changed(late.holdout[0])]
    assert "held out twice" in refused(late, list(late.calibration), twice)


def test_a_motor_on_the_rear_axle_is_warned_of_where_it_is_not_named():
    case = draw("single", 41, names=("regenerative_torque",), severity=2, only=FIVE)
    assert case.hidden.regen_axle == 1
    warnings = runs.checked(case.vehicle, list(case.calibration), list(case.holdout))
    assert "axles_swapped" in {warning.code for warning in warnings}
    assert runs.unexplained_warnings(warnings, unexplained=False, grouped=False) == ()
    remaining = runs.unexplained_warnings(warnings, unexplained=True, grouped=False)
    assert set(remaining) == set(warnings)


def test_other_mistakes_in_one_log_are_refused_in_the_words_of_check(late):
    hot, radius = named(late, "hot"), late.vehicle.rear.rolling_radius
    for change, message in (
        (lambda log: changed(log, a_x=-log["a_x"]), "a_x_sign"),
        (lambda log: changed(log, p_mc=0.0 * log["p_mc"]), "stuck"),
        (lambda log: changed(log, v=radius * log["omega_rl"]), "v_of_wheels"),
        (lambda log: changed(log, p_mc=0.4 * log["p_mc"]), "level_changed"),
    ):
        text = refused(late, with_(late, "hot", change))
        assert text.startswith(f"{hot.source}: ")
        assert message in text


def test_a_pressure_of_another_run_is_refused(late):
    other = named(late, "release")["p_mc"]
    index = np.arange(named(late, "hot").time.size)
    pressure = other[np.minimum(index, other.size - 1)]
    message = refused(late, with_(late, "hot", lambda log: changed(log, p_mc=pressure)))
    assert "pressure_foreign" in message or "pressure_late" in message


def test_a_zero_of_the_pressure_is_warned_of_whatever_was_found(late):
    logs = with_(late, "hot", lambda log: changed(log, p_mc=log["p_mc"] + 0.8e5))
    warnings = runs.checked(late.vehicle, logs, list(late.holdout))
    remaining = runs.unexplained_warnings(warnings, unexplained=False, grouped=False)
    assert [(warning.code, warning.log) for warning in remaining] == [("pressure_zero", "hot")]


def test_clean_logs_are_not_complained_of():
    case = draw("none", 70)
    assert runs.checked(case.vehicle, list(case.calibration), list(case.holdout)) == ()


SWAPPED = ("coast", "ramp", "hot", "mixed")


@pytest.mark.parametrize("all_logs", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_swapped_axles_are_refused_by_the_logs_in_which_they_show(all_logs):
    case = draw("none", 60, only=SWAPPED)
    logs = [swapped(log) for log in case.calibration] if all_logs else list(case.calibration)
    with pytest.raises(LogError, match="axles_swapped") as error:
        diagnose(case.vehicle, logs, [swapped(log) for log in case.holdout])
    expected = {"mixed.csv", "ramp.csv", "hot.csv"} if all_logs else {"mixed.csv"}
    assert set(str(error.value.where).split(", ")) == expected


@pytest.mark.slow
def test_a_motor_on_the_rear_axle_is_no_swap():
    case = draw("single", 41, names=("regenerative_torque",), severity=2)
    assert case.hidden.regen_axle == 1
    assert [effect.name for effect in diagnosed(case).effects] == ["regenerative_torque"]


def scaled(log, factors):
    return changed(log, **{f"omega_{w}": by * log[f"omega_{w}"] for w, by in factors.items()})


def test_unlike_radii_of_left_and_right_are_taken_out_and_axles_stay():
    logs = draw("none", 11, only=FIVE[:3]).calibration
    even, _ = runs.with_even_sides(logs, runs.USUAL_DIFFERENCE)
    uneven = [scaled(log, {"fl": 1.0005, "fr": 0.9997, "rr": 1.0006}) for log in logs]
    again, taken_out = runs.with_even_sides(uneven, runs.USUAL_DIFFERENCE)
    for first, second in zip(even, again, strict=True):
        for axle, mean in (("f", np.sqrt(1.0005 * 0.9997)), ("r", np.sqrt(1.0006))):
            for name in (f"omega_{axle}l", f"omega_{axle}r"):
                assert second[name] == pytest.approx(mean * first[name], rel=1e-9)
    other_way = [scaled(log, {"fl": 0.9997, "fr": 1.0005}) for log in logs]
    # what the sensors themselves differ by is in both, with another sign
    mean = 0.5 * (taken_out + runs.with_even_sides(other_way, runs.USUAL_DIFFERENCE)[1])
    assert mean == pytest.approx(0.0008, abs=2e-6)


def test_more_than_tyres_make_is_left_in():
    logs = [scaled(log, {"rl": 1.003}) for log in draw("none", 11, only=FIVE[:3]).calibration]
    for log, even in zip(logs, runs.with_even_sides(logs, runs.USUAL_DIFFERENCE)[0], strict=True):
        assert np.array_equal(even["omega_rl"], log["omega_rl"])
    assert runs.with_even_sides(logs, runs.LARGEST_DIFFERENCE)[1] == pytest.approx(0.003, abs=2e-4)


@pytest.mark.slow
def test_a_wheel_whose_brake_drags_is_no_new_tyre():
    few = ("coast", "ramp", "step_high", "hot_stop")
    diagnosis = diagnosed(draw("outside", 3, names=("seized_wheel",), only=few))
    assert diagnosis.verdict == "unknown"
    assert diagnosis.unexplained.wheel.startswith("rear_")
