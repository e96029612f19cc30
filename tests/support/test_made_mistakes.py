"""The lines and mistakes of the study: each mistake sits where it says, and nowhere else."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from calib.logs.log import Log
from tests.studies.causes import CAUSES, RAMP, STOP
from tests.studies.ensemble import LEVELS
from tests.studies.made_lines import RUNS, Line, line, recorded
from tests.studies.made_mistakes import KINDS
from tests.support.reference_car import IDEAL

OF_THE_FILE = {
    "centre of gravity too high", "mass of the file", "pad ratio of the file",
    "piston area of one axle", "rolling radius, both", "rolling radius, one axle", "wheel inertia",
}  # fmt: skip


@cache
def good() -> tuple[Line, dict[str, Log]]:
    drawn = line(np.random.default_rng(3), 3)
    drawn = replace(drawn, sensors=replace(drawn.sensors, with_v=True))
    return drawn, {name: recorded(name, drawn.runs[name], drawn.sensors) for name in RUNS}


@pytest.mark.parametrize("name", KINDS)
def test_a_mistake_sits_where_it_says(name):
    kind, (drawn, logs) = KINDS[name], good()
    mistake = kind.make(np.random.default_rng(5))
    made, written = mistake.line(drawn), mistake.logs(logs)
    driven = {run for run in RUNS if made.runs[run] is not drawn.runs[run]}
    wrong = {run for run in RUNS if written[run] is not logs[run]}
    assert (made.file != drawn.file) == (name in OF_THE_FILE)
    assert made.sensors is drawn.sensors
    if name in OF_THE_FILE:
        assert not driven | wrong
    elif name == "ramp as hold-out":
        assert wrong == {"stop_1"}
    else:
        assert driven | wrong == set(kind.runs)
    for run in wrong:
        channels = written[run].channels
        assert any(not np.array_equal(channels[c], logs[run][c]) for c in channels)
    assert mistake.size
    re.compile(kind.named)


@pytest.mark.parametrize("name", CAUSES)
def test_a_cause_is_hidden_somewhere(name):
    hidden = CAUSES[name](np.random.default_rng(5))
    log = good()[1]["stop_1"]
    changed = [hidden.car(role, IDEAL, lambda t: 1e6, 25.0) != IDEAL for role in (RAMP, STOP)]
    changed.append(hidden.told(IDEAL.vehicle) != IDEAL.vehicle)
    changed.append(hidden.levels(LEVELS) != LEVELS)
    seen = hidden.sense(STOP, log)
    changed.append(any(not np.array_equal(seen[c], log[c]) for c in log.channels))
    assert any(changed) == (name != "control")
