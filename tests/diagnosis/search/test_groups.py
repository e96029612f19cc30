"""Logs with other pads or on another road, made by a plant that shares no code with the search."""

from dataclasses import replace

import numpy as np
import pytest

from calib.diagnosis.explanation.base import REFERENCE, Ground
from calib.diagnosis.search.decide import decide
from calib.diagnosis.search.groups import grouped, groups_of, placed
from calib.diagnosis.search.regroup import regrouped
from tests.support.explained import based, diagnosed
from tests.support.hidden.cases import draw

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def case():
    """Ramp and one stop of eight with pads 6 % and 11 % lower; nothing hidden."""
    return draw("groups", 731002)


def test_logs_with_other_pads_are_found_with_their_factors(case):
    found = diagnosed(case)
    assert found.verdict == "no_gap"
    variety = case.answer["variety"]
    logs = (*case.calibration, *case.holdout)
    other = {log.name for log, at in zip(logs, variety["of_run"], strict=True) if at}
    reference, apart = found.groups
    assert set(apart.logs) == other
    assert reference.ground == REFERENCE
    front, rear = variety["grounds"][1]["pad_scale"]
    assert apart.ground.pad_friction_f == pytest.approx(front, abs=0.01)
    assert apart.ground.pad_friction_r == pytest.approx(rear, abs=0.02)
    assert apart.ground.stiffness == pytest.approx(1.0, abs=0.02)
    # and the hold-outs are replayed on their own ground
    assert found.gap.before < 2.0


def test_logs_of_one_car_on_one_road_are_one_group():
    base = based(draw("none", 33))
    assert grouped(base.problem, base) is None
    assert groups_of(base.problem.runs) == ()
    decision = decide(base)
    assert regrouped(decision) is decision


def test_a_further_log_is_placed_on_the_ground_that_fits_it(case):
    base, ground = based(case), Ground(0.9, 0.85, 1.0, 1.0)
    first, *others = base.problem.runs
    split = replace(base.problem, runs=(replace(first, ground=ground), *others))
    stop = next(run for run in base.problem.runs if run.name == "hot")
    (own,) = placed(split, [stop], base)
    weaker = base.base.pad_friction_f / 0.9, base.base.pad_friction_r / 0.85
    stronger = replace(base.base, pad_friction_f=weaker[0], pad_friction_r=weaker[1])
    (moved,) = placed(split, [stop], replace(base, base=stronger))
    assert (own.ground, moved.ground) == (REFERENCE, ground)


def test_a_ground_multiplies_the_base(case):
    base = based(case).base
    ground = Ground.of(np.log([0.9, 1.1, 0.8, 0.7]))
    moved = ground.applied(base)
    assert moved.pad_friction_f == pytest.approx(0.9 * base.pad_friction_f)
    assert moved.peak == pytest.approx(0.7 * base.peak)
    assert moved.shape == base.shape
    assert ground.logarithms == pytest.approx(np.log([0.9, 1.1, 0.8, 0.7]))
    assert REFERENCE.applied(base) is base
