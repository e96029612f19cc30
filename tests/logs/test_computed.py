"""Pressures that a decoder computed from another column."""

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.logs.computed import computed_pressures
from calib.logs.read import read_log
from calib.logs.source import Column, ColumnSource
from calib.plausibility.check import check
from calib.plausibility.rules import COAST, DIAGNOSE, FIT, VALIDATE, require
from calib.run.run import Run
from tests.support.made_runs import made_run, stop

RUN = made_run(stop())


def test_a_pressure_made_of_a_torque_is_refused_by_whoever_uses_the_log(tmp_path):
    torque = np.round(RUN["p_mc"] / 1e5 * 75, 1)
    columns = RUN.channels | {"p_mc": torque / 75 * 1e5, "asked_for": torque}
    units = {"time": "s", "p_mc": "Pa", "a_x": "m/s^2", "v": "m/s", "asked_for": "Nm"}
    heads = [f"{name} [{units.get(name, 'rad/s')}]" for name in columns]
    file = tmp_path / "run.csv"
    np.savetxt(file, np.stack([*columns.values()], 1), delimiter=",", header=",".join(heads),
               comments="")  # fmt: skip
    log = read_log(file)
    assert log.computed[0][:3] == ("p_mc", pytest.approx(1 / 75), "asked_for")
    assert not check(log).usable
    for purpose in (FIT, COAST, VALIDATE, DIAGNOSE):
        with pytest.raises(LogError, match="pressure_derived"):
            require(Run(log), purpose)


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
def test_what_is_no_computed_pressure(unit, values):
    source = ColumnSource((Column("other", unit),), lambda indices: [values])
    assert not list(computed_pressures(RUN.channels, ["other"], source))
