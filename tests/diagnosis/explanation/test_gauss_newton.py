"""A fit of pads and tyres without the cause ends where nothing falls, though bounds hold them."""

from dataclasses import replace

import numpy as np

import calib
from calib.diagnosis.explanation.fit import linearised
from calib.diagnosis.explanation.gauss_newton import fit_logs
from calib.diagnosis.explanation.hypothesis import Hypothesis, start_of
from calib.diagnosis.explanation.unknowns import BASE_SIZE
from tests.support.explained import problem_of_logs

LATE = calib.sample_logs() / "hidden" / "case_2"
"""A car whose pressure is late: pads and tyres go to their bounds to make up for it."""


def test_no_parameter_alone_is_better_elsewhere():
    logs = [calib.read_log(LATE / f"calibration/{run}.parquet") for run in ("release", "step_high")]
    problem = problem_of_logs(calib.read_vehicle(LATE / "vehicle.toml"), logs)
    fit = fit_logs(problem, Hypothesis(), start_of(problem))
    for step in np.vstack([size * np.eye(BASE_SIZE) for size in (-0.1, -0.01, 0.01, 0.1)]):
        x = np.clip(fit.state.x + step, fit.prior.low[:BASE_SIZE], fit.prior.high[:BASE_SIZE])
        other = linearised(problem, fit.hypothesis, replace(fit.state, x=x), fit.columns)
        assert fit.squares - other.squares < 1e-3 * (fit.squares - fit.count)
