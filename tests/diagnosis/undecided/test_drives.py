"""The drive that would show what the logs could not: it does so when it is simulated.

`calib.model.simulate` integrates the motion and shares no step with the prediction that chose
the drive.
"""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.effects.catalogue import CATALOGUE
from calib.car.effects.effects import Effects
from calib.diagnosis.replays.hold_outs import model_of
from calib.diagnosis.search.rank import further_columns
from calib.diagnosis.undecided.drives import drives, unresolved
from calib.diagnosis.undecided.separate import manoeuvres
from calib.model.simulate import simulate
from tests.support.explained import based, fitted
from tests.support.hidden.cases import draw


@pytest.fixture(scope="module")
def cold():
    """A light stop of a car that lacks nothing: no heat, little speed, one pressure."""
    return based(draw("none", 42, only=("step_low",)))


def changed(at, name, run) -> float:
    """Rms of v that an effect of usual size changes in a manoeuvre, driven open loop [m/s]."""
    model = model_of(at.problem.vehicle, at.base, at.effects)
    with_it = replace(model, effects=Effects({name: CATALOGUE[name].card.usual}))
    heat = {} if run.temperature_f is None else {"f": run.temperature_f, "r": run.temperature_r}
    one, other = (
        simulate(m, run.time, run.p_mc, float(run.v[0]), temperature=heat) for m in (model, with_it)
    )
    n = min(one.time.size, other.time.size)
    return float(np.sqrt(np.mean((one["v"][:n] - other["v"][:n]) ** 2)))


def test_drag_is_seen_in_a_coast_and_fade_in_a_hard_stop(cold):
    drag, fade = drives(cold, ("aerodynamic_drag", "pad_thermal_fade"))
    assert drag.clear
    assert fade.clear
    assert drag.name.startswith("coast down from 130")
    assert "45 bar" in fade.name
    tests = dict(manoeuvres(cold))
    weak = tests["light stop at 8 bar from 60 km/h"]
    for drive in (drag, fade):
        strong = tests[drive.name]
        shown = changed(cold, drive.effect, strong)
        assert shown > 2.0 * changed(cold, drive.effect, weak)


def test_what_pads_imitate_is_taken_out(cold):
    """A mass scales all forces of the brakes, and so do the pads."""
    (mass,) = drives(cold, ("mass_error",))
    assert not mass.clear
    run = dict(manoeuvres(cold))[mass.name]
    assert changed(cold, "mass_error", run) > 0.1  # though it changes the drive a lot


def test_more_of_it_shows_more(cold):
    """The logs themselves count: after a coast in them, drag shows at least as clearly."""
    (alone,) = drives(cold, ("aerodynamic_drag",))
    coast = dict(manoeuvres(cold))["coast down from 130 km/h"]
    more = replace(cold.problem, runs=(*cold.problem.runs, coast))
    (both,) = drives(fitted(more), ("aerodynamic_drag",))
    assert both.sigma > 1.2 * alone.sigma


def test_a_cold_car_cannot_show_fade_and_coasting_shows_drag():
    base = based(draw("none", 42, only=("coast", "step_low")))
    silent = unresolved(base, further_columns(base))
    assert {"pad_thermal_fade", "mass_error"} <= set(silent)
    assert not {"aerodynamic_drag", "accelerometer_bias"} & set(silent)
