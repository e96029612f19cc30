"""Pressure traces: their corners, their clock, and what cannot be driven."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.errors import ModelError
from calib.model.manoeuvre import LEAD_IN, NAMES, manoeuvre


@given(st.sampled_from(NAMES), st.floats(40.0, 1000.0), st.floats(5e5, 120e5))
def test_every_trace_is_an_even_clock_and_a_pressure_that_can_be_built(name, rate, pressure):
    time, trace = manoeuvre(name, None if name == "coast" else pressure, rate)
    assert time[0] == 0.0
    assert np.diff(time) == pytest.approx(1.0 / rate, rel=1e-6)
    assert time.shape == trace.shape
    assert np.all(trace >= 0.0)
    assert np.all(np.abs(np.diff(trace)) <= 400e5 / rate * (1.0 + 1e-6))
    if name != "coast":
        assert np.all(trace[time <= LEAD_IN - 1.0 / rate] == 0.0)


# bar by second: 5 bar/s in a ramp, 80 in a stop, 400 in a step
CORNERS = {
    "ramp": {1.5: 0.0, 2.5: 5.0, 7.5: 30.0, 13.5: 60.0, 14.5: 60.0},
    "step": {1.5: 0.0, 1.575: 30.0, 21.575: 30.0},
    "stop": {1.5: 0.0, 1.75: 20.0, 1.875: 30.0, 30.0: 30.0},
    "coast": {0.0: 0.0, 20.0: 0.0},
}


@pytest.mark.parametrize("name", CORNERS)
def test_a_trace_goes_through_its_corners(name):
    time, trace = manoeuvre(name)
    pressures = np.interp(list(CORNERS[name]), time, trace) / 1e5
    assert pressures == pytest.approx(list(CORNERS[name].values()), abs=1e-6)


@pytest.mark.parametrize(
    "arguments",
    [
        ("rmap",),
        ("coast", 30e5),
        ("ramp", -1.0),
        ("ramp", np.nan),
        ("ramp", None, 10.0),
        ("coast", None, 2000.0),
        ("stop", None, 200.0, 0.0),
        ("stop", None, 200.0, 1e9),
    ],
)
def test_refuses_what_cannot_be_driven(arguments):
    with pytest.raises(ModelError):
        manoeuvre(*arguments)
