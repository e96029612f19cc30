"""Figures of a log have one name in `check --json` and in the results of a batch."""

import pytest

from calib.line.fleet.rows import Command, columns_of
from calib.run.check import check, to_dict
from calib.run.figures import figures
from tests.support.made_runs import made_run, ramp


def test_the_columns_of_a_batch_are_these():
    columns = [c.name for c in columns_of(Command.CHECK) if c.kind is float]
    assert list(figures(check(made_run()).seen)) == columns


def test_they_are_those_of_the_run_as_it_was_made():
    told = to_dict(check(made_run(ramp(start=1.5), rate=200.0, speed=30.0)))
    assert told["figures"]["rate"] == pytest.approx(200.0)
    assert told["figures"]["brakings"] == 1
    assert told["figures"]["speed_max"] == pytest.approx(30.0, rel=0.01)
    assert told["figures"]["lead_in"] == pytest.approx(1.5, abs=0.2)
    assert told["warned"] == []
