"""Pressures that were computed from something else."""

import numpy as np
import pytest

from calib.logs.log import Log
from calib.logs.source import Column, ColumnSource
from calib.run.check import check
from calib.run.copies import computed_channels, factor_between
from tests.support.made_runs import made_run, stop

RUN = made_run(stop())


def log_with(unit, values):
    log = Log("run", "run.csv", "", RUN.channels, ignored=("other",))
    source = ColumnSource((Column("other", unit),), lambda indices: [values])
    return log, source


def test_a_pressure_made_of_a_torque_is_found_and_refused():
    log, source = log_with("Nm", np.round(RUN["p_mc"] / 1e5 * 75, 1))
    (copy,) = computed_channels(log, source)
    assert (copy.channel, copy.source, copy.unit) == ("p_mc", "other", "N*m")
    assert copy.factor == pytest.approx(1 / 75, rel=1e-3)
    findings = check(log, (copy,))
    assert not findings.usable
    assert all("times other [N*m]" in v.reasons[0] for v in findings.verdicts)


@pytest.mark.parametrize(
    ("unit", "values"),
    [
        ("kPa", RUN["p_mc"] / 1e3),  # the same pressure again
        ("furlong", RUN["p_mc"]),
        (None, RUN["p_mc"]),
        ("N*m", RUN["p_mc"] + np.random.default_rng(1).normal(0, 0.1e5, RUN.time.size)),
        ("N*m", np.zeros(RUN.time.size)),
    ],
)
def test_what_is_no_copy(unit, values):
    assert computed_channels(*log_with(unit, values)) == ()


@pytest.mark.parametrize("factor", [0.01, -3.0, 1e6])
def test_factor(factor):
    x = np.random.default_rng(2).normal(size=50)
    assert factor_between(factor * x, x) == pytest.approx(factor)
    assert factor_between(factor * (x + 0.1), x) is None
