"""Whole diagnoses of cases of the hidden plant, which shares nothing with the program.

A handful here; tests/studies/naming.py scores hundreds.
"""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.diagnosis.diagnose import diagnose
from calib.diagnosis.diagnosis import Diagnosis, to_dict
from tests.support.explained import diagnosed
from tests.support.hidden.cases import HiddenCase, draw
from tests.support.measuring_chain import Message, chained
from tests.support.rounding import moved

THREE = ("coast", "ramp", "stop_a")
"""Runs of a case that is not all driven: two to learn from, one held out."""


class Unread(dict[str, Array]):
    """Truth channels that nobody may read."""

    def __getitem__(self, name: str) -> Array:
        raise AssertionError(f"{name} was read")

    get = items = values = __iter__ = __contains__ = __getitem__  # type: ignore[assignment]


@pytest.fixture(scope="module")
def drag() -> HiddenCase:
    """Drag; every log with a digest of its own, as a file has, and a truth that nobody may read."""
    case = draw("single", 11, ("aerodynamic_drag",), severity=1, only=THREE)
    named = [
        [replace(log, digest=log.name, truth=Unread()) for log in part]
        for part in (case.calibration, case.holdout)
    ]
    return replace(case, calibration=tuple(named[0]), holdout=tuple(named[1]))


@pytest.fixture(scope="module")
def reported(drag) -> tuple[Diagnosis, list[tuple[str, int, int]]]:
    """The diagnosis of the drag, and the reports of its progress."""
    stages = list[tuple[str, int, int]]()
    logs = list(drag.calibration), list(drag.holdout)
    return diagnose(drag.vehicle, *logs, lambda *stage: stages.append(stage)), stages


def test_a_single_effect_is_named_with_an_interval_that_holds_it(drag, reported):
    diagnosis, steps = reported
    assert diagnosis.verdict == "named"
    assert [effect.name for effect in diagnosis.effects] == ["aerodynamic_drag"]
    low, high = diagnosis.effects[0].parameters["drag_area"].ci95
    assert low <= drag.hidden.drag_area <= high
    assert diagnosis.gap.closed > 0.8
    assert diagnosis.gap.rms_after < 1.5  # in units of the noise
    assert all(0 <= done < total for _, done, total in steps)
    assert len({stage for stage, _, _ in steps}) > 4


@pytest.mark.slow
def test_a_cause_outside_the_catalogue_beside_an_effect_is_reported():
    """A drag of the catalogue, beside brakes that weaken, which no card has."""
    names = ("aerodynamic_drag", "weaker_applications")
    diagnosis = diagnosed(draw("double", 72, names=names, severity=1))
    assert diagnosis.verdict in ("named", "unknown")
    assert {effect.name for effect in diagnosis.effects} <= {"aerodynamic_drag"}
    assert to_dict(diagnosis)["unexplained"]["size"] > 0.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "seed", "names", "severity", "named"),
    [
        ("double", 13, ("rolling_resistance", "hydraulic_delay"), 1, None),
        ("single", 1, ("caliper_hysteresis",), 2, None),  # of fixed width
        # The links carry the rest of the load transfer at once: no effect of its own name.
        ("single", 88101, ("anti_dive",), 1, ("pitch_coupling",)),
        ("single", 1790017, ("residual_torque",), None, None),  # not exchanged for itself
        ("outside", 1480002, ("abs_modulation",), None, ()),  # and not four effects
    ],
)
def test_what_is_named(kind, seed, names, severity, named):
    diagnosis = diagnosed(draw(kind, seed, names, severity))
    assert {effect.name for effect in diagnosis.effects} == set(names if named is None else named)
    assert (diagnosis.verdict == "unknown") == (kind == "outside")


def in_words(diagnosis: Diagnosis) -> tuple[object, ...]:
    """What a diagnosis says in words."""
    effects = [(e.name, e.where.channel, e.where.axle) for e in diagnosis.effects]
    codes = [warning.code for warning in diagnosis.warnings]
    return diagnosis.verdict, diagnosis.unexplained, effects, codes


def numbers(diagnosis: Diagnosis) -> dict[str, tuple[float, float, float]]:
    """Every parameter with its interval."""
    of_effects = {f"{e.name} {p}": x for e in diagnosis.effects for p, x in e.parameters.items()}
    return {name: (x.value, *x.ci95) for name, x in (of_effects | diagnosis.base).items()}


def test_a_diagnosis_does_not_depend_on_the_last_digits(drag, reported):
    """Nor on those of a matrix product."""
    diagnosis, other = reported[0], diagnosed(moved(drag, 1))
    assert in_words(other) == in_words(diagnosis)
    for name, (value, low, high) in numbers(diagnosis).items():
        change = np.abs(numbers(other)[name] - np.array([value, low, high])).max()
        assert change <= 1e-4 * (high - low), name


@pytest.mark.slow
def test_the_order_of_the_logs_does_not_matter(drag, reported):
    other = diagnose(drag.vehicle, list(drag.calibration)[::-1], list(drag.holdout))
    assert to_dict(reported[0]) == to_dict(other)


@pytest.mark.slow
def test_what_each_log_has_of_its_own_is_no_effect():
    """Pads of each log beside a cause; slopes and zeros of each are in `test_verdict.py`."""
    case = draw("unlike", 3, ("pad_speed_dependence",), severity=1)
    diagnosis = diagnosed(case)
    assert [effect.name for effect in diagnosis.effects] == ["pad_speed_dependence"]
    assert (diagnosis.verdict, diagnosis.unexplained, diagnosis.warnings) == ("named", None, ())
    assert diagnosis.gap.rms_after < 2.0


LATE = {
    "p_mc": Message(100.0, 0.005),
    "a_x": Message(50.0, 0.02, corner=15.0),
    "omega": Message(100.0, 0.01),
    "v": Message(20.0, 0.06),
}


@pytest.mark.slow
def test_channels_that_a_bus_sends_late_are_named_as_that_together():
    case, rng = draw("none", 4402), np.random.default_rng(5)
    parts = (case.calibration, case.holdout)
    calibration, holdout = (tuple(chained(log, LATE, rng) for log in part) for part in parts)
    diagnosis = diagnosed(replace(case, calibration=calibration, holdout=holdout))
    assert diagnosis.verdict == "named"
    late = {effect.name: effect.parameters for effect in diagnosis.effects}
    delays = ("hydraulic_delay", "speed_delay", "wheel_speed_delay", "accelerometer_lag")
    assert late.keys() <= set(delays)
    # against the wheels, as all of them are late against p_mc besides
    apart = late["speed_delay"]["v_delay"].value
    if "wheel_speed_delay" in late:
        apart -= late["wheel_speed_delay"]["omega_delay"].value
    assert apart == pytest.approx(0.05, abs=0.006)
    # two poles of 15 Hz are a delay of 15 ms, and 20 ms come besides
    assert late["accelerometer_lag"]["filter_time"].value == pytest.approx(0.03, abs=0.015)


def test_logs_that_cannot_give_an_answer_are_refused(drag):
    logs, holdouts = list(drag.calibration), list(drag.holdout)
    larger = replace(drag.vehicle.front, rolling_radius=1.1 * drag.vehicle.front.rolling_radius)
    few = ("coast", "coast_slow")
    coasts = list(draw("single", 11, ("aerodynamic_drag",), severity=1, only=few).calibration)
    blind = [
        replace(log, channels={k: v for k, v in log.channels.items() if k != "v"}) for log in logs
    ]
    for vehicle, calibration, holdout, message in (
        (drag.vehicle, logs, [], "no hold-out"),
        (drag.vehicle, logs, [logs[0]], "among the calibration logs"),
        (drag.vehicle, [*logs, logs[0]], holdouts, "given twice"),
        (replace(drag.vehicle, front=larger), logs, holdouts, "rolling_radius_f"),
        (drag.vehicle, logs[:1], holdouts, "two or more"),
        (drag.vehicle, coasts, holdouts, "nothing is braked"),
        (drag.vehicle, blind, holdouts, "no reference speed"),
    ):
        with pytest.raises(LogError, match=message):
            diagnose(vehicle, calibration, holdout)
