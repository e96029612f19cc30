"""Plans on few measures: the wanted widths and the time decide, and a plant agrees."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import InputError
from calib.car.mass import WEIGHED, mass_used
from calib.fitting.fit import fit
from calib.logs.read import read_log
from calib.model.sensor_noise import add_noise
from calib.plan import search
from calib.plan.achieved import DOCUMENT, HalfWidths, compare, read_plan
from calib.plan.expected import noise_of, prior_of
from calib.plan.files import document, pressure_files
from calib.plan.measure import Track, measures, pressure_trace
from calib.plan.search import Want, plan
from tests.support.plant import Plant, as_log, brush, drive
from tests.support.reference_car import CAR as WEIGHED_CAR

CAR = replace(WEIGHED_CAR, mass_tolerance=0.03)
RUNS = {measure.name: measure for measure in measures()}
FEW = tuple(RUNS[name] for name in ("ramp_60_3", "coast", "weighing", "rear_alone"))
PRIOR = prior_of(CAR, Track(speed=33.0), frozenset({"v"}))


@pytest.fixture(scope="module")
def planned():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(search, "measures", lambda: FEW)
        patch.setattr(search, "_CARS", 1)
        return plan(PRIOR, Want())


def test_the_car_is_weighed_and_a_coast_is_not_worth_its_time(planned):
    assert [step.measure.name for step in planned.steps] == ["ramp_60_3", "weighing"]
    assert [measure.name for measure in planned.not_worth] == ["coast"]
    assert [measure.name for measure in planned.impossible] == ["rear_alone"]


def test_the_mass_bounds_what_any_run_can_tell(planned):
    # mass multiplies the pads of both axles: two sigmas of it are there whatever is driven
    for widths in (planned.steps[0].widths, planned.floor_of_runs):
        assert min(widths) > 1.95 * CAR.mass_tolerance
    assert 1.95 * WEIGHED < planned.after.total < 0.5 * planned.steps[0].widths.total
    assert planned.floor.total <= 1.05 * planned.after.total


@pytest.fixture(scope="module")
def runs(planned, tmp_path_factory):
    """The plan as it is read from its file."""
    path = tmp_path_factory.mktemp("plan") / DOCUMENT
    path.write_text(json.dumps(document(planned)))
    return read_plan(path)


def test_a_plant_reaches_what_was_planned(planned, runs):
    run = planned.steps[0].measure
    time, pressure = pressure_trace(CAR, run)
    pads = 0.93 * CAR.front.pad_friction, 1.04 * CAR.rear.pad_friction
    plant = Plant(CAR, brush(30.0, 0.95), pads=lambda t: pads, rolling_resistance=0.011)
    driven = drive(plant, lambda t: float(np.interp(t, time, pressure)), 33.0, duration=time[-1])
    log = add_noise(as_log(driven), 5)
    weighed = mass_used(CAR, CAR.mass)
    table = fit(CAR, [log], mass=CAR.mass)
    reached = compare(runs, table, [log], weighed)
    for width, planned_width in zip(reached.achieved, reached.planned, strict=True):
        assert 0.85 < width / planned_width < 1.25
    assert reached.reasons == ()
    unweighed = compare(runs, fit(CAR, [log]), [log], mass_used(CAR, None))
    assert not unweighed.reached
    assert len(unweighed.reasons) == 1


@pytest.mark.parametrize(
    ("want", "steps"),
    [(Want(HalfWidths(total=0.1)), ["ramp_60_3"]), (Want(seconds=30.0), ["ramp_60_3"])],
    ids=["wide enough after the ramp", "no time to weigh"],
)
def test_a_plan_ends_when_it_is_met_or_the_time_is_over(monkeypatch, want, steps):
    monkeypatch.setattr(search, "_CARS", 1)
    monkeypatch.setattr(search, "measures", lambda: (FEW[0], FEW[2]))
    planned = plan(PRIOR, want)
    assert [step.measure.name for step in planned.steps] == steps
    assert planned.seconds <= want.seconds


def test_gain_counts_what_is_asked_and_not_beyond():
    wide, narrow = HalfWidths(0.08, 0.12, 0.06), HalfWidths(0.04, 0.12, 0.06)
    assert Want().gain(wide, narrow) == pytest.approx(math.log(2.0))
    assert Want(HalfWidths(front=0.06)).gain(wide, narrow) == pytest.approx(math.log(0.08 / 0.06))
    assert Want(HalfWidths(rear=0.05)).gain(wide, narrow) == 0.0


def test_files_for_the_robot_are_read_as_pressures(planned, tmp_path):
    (name, content), *more = pressure_files(planned)
    assert not more
    (tmp_path / name).write_bytes(content)
    log = read_log(tmp_path / name, require=("time", "p_mc"))
    time, pressure = pressure_trace(CAR, planned.steps[0].measure)
    assert np.allclose(log["p_mc"], pressure, atol=100.0)
    assert np.allclose(log.time, time)


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"steps": 3}', '{"after": null, "steps": []}'])
def test_a_file_that_is_no_plan_is_refused(text, tmp_path):
    (tmp_path / DOCUMENT).write_text(text)
    with pytest.raises(InputError):
        read_plan(tmp_path / DOCUMENT)


def test_noise_of_a_table_is_that_of_its_densities():
    levels = noise_of({"omega": 0.002, "z": 0.001, "v": 0.003})
    # a mean of 1 s of white noise has the density as its standard deviation
    assert levels["a_x"].sd / 10.0 == pytest.approx(0.001 * 9.80665)
    assert levels["omega_fl"].sd / 10.0 / math.sqrt(2.0) == pytest.approx(0.002)
    assert replace(PRIOR, noise=levels).noise["v"].sd == pytest.approx(0.03)
