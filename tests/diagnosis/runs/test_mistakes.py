"""Mistakes of the people who record logs are refused before the search; hidden effects are not."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.diagnosis.runs.mistakes import checked, unexplained_warnings
from calib.logs.log import Log
from tests.support.hidden.cases import HiddenCase, draw


@pytest.fixture(scope="module")
def late() -> HiddenCase:
    """A car whose brakes lag: the pressure does not go with the deceleration at once."""
    return draw("single", 21, names=("hydraulic_lag",), severity=2, only=FIVE)


FIVE = ("coast", "ramp", "hot", "release", "hot_stop")


def changed(log: Log, **channels: np.ndarray) -> Log:
    return replace(log, channels=log.channels | channels, digest=f"{log.digest} changed")


def refused(case: HiddenCase, logs: list[Log], held: list[Log] | None = None) -> str:
    with pytest.raises(LogError) as error:
        checked(case.vehicle, logs, list(case.holdout) if held is None else held)
    return str(error.value)


def with_(case: HiddenCase, name: str, change) -> list[Log]:
    assert name in [log.name for log in case.calibration]
    return [change(log) if log.name == name else log for log in case.calibration]


def named(case: HiddenCase, name: str) -> Log:
    return next(log for log in (*case.calibration, *case.holdout) if log.name == name)


def test_a_copy_of_a_calibration_log_is_no_hold_out(late):
    ramp = named(late, "ramp")
    copy = Log("mine", "mine.parquet", "", {n: x[200:] for n, x in ramp.channels.items()})
    said = refused(late, list(late.calibration), [*late.holdout, copy])
    assert said.startswith(f"mine.parquet: the same run as {ramp.source}")
    assert "no hold-out and proves nothing" in said
    assert "given twice" in refused(late, [*late.calibration, copy])
    assert "held out twice" in refused(
        late, list(late.calibration), [*late.holdout, changed(late.holdout[0])]
    )


def test_a_motor_on_the_rear_axle_is_warned_of_where_it_is_not_named():
    case = draw("single", 41, names=("regenerative_torque",), severity=2, only=FIVE)
    assert case.hidden.regen_axle == 1
    warnings = checked(case.vehicle, list(case.calibration), list(case.holdout))
    assert "axles_swapped" in {one.code for one in warnings}
    assert unexplained_warnings(warnings, left=False, grouped=False) == ()
    assert set(unexplained_warnings(warnings, left=True, grouped=False)) == set(warnings)


def test_other_mistakes_in_one_log_are_refused_in_the_words_of_check(late):
    hot, radius = named(late, "hot"), late.vehicle.rear.rolling_radius
    for change, said in (
        (lambda log: changed(log, a_x=-log["a_x"]), "a_x_sign"),
        (lambda log: changed(log, p_mc=0.0 * log["p_mc"]), "stuck"),
        (lambda log: changed(log, v=radius * log["omega_rl"]), "v_of_wheels"),
        (lambda log: changed(log, p_mc=0.4 * log["p_mc"]), "level_changed"),
    ):
        text = refused(late, with_(late, "hot", change))
        assert text.startswith(f"{hot.source}: ")
        assert said in text


def test_a_pressure_of_another_run_is_refused(late):
    other = named(late, "release")["p_mc"]
    at = np.arange(named(late, "hot").time.size)
    taken = other[np.minimum(at, other.size - 1)]
    said = refused(late, with_(late, "hot", lambda log: changed(log, p_mc=taken)))
    assert "pressure_foreign" in said or "pressure_late" in said


def test_a_zero_of_the_pressure_is_warned_of_whatever_was_found(late):
    logs = with_(late, "hot", lambda log: changed(log, p_mc=log["p_mc"] + 0.8e5))
    warnings = checked(late.vehicle, logs, list(late.holdout))
    kept = unexplained_warnings(warnings, left=False, grouped=False)
    assert [(one.code, one.log) for one in kept] == [("pressure_zero", "hot")]


def test_clean_logs_are_not_complained_of():
    case = draw("none", 70)
    assert checked(case.vehicle, list(case.calibration), list(case.holdout)) == ()
