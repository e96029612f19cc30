"""What acts for a moment in a ramp is left out of the fit, and told; nothing else is."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.fitting.fit import fit
from tests.support.reference_car import CAR, REAL, noisy, ramp, without

TRUE = CAR.front.pad_friction, CAR.rear.pad_friction
HIDDEN = "T_drive_f", "T_drive_r"


def bump(x, start=160.0, length=3.0):
    """Load over that of an even road [1]: less, more, then two turns of a hop."""
    along = (x - start) / length
    if not 0.0 < along < 4.0:
        return 1.0
    return 1.0 - 0.5 * math.sin(2.0 * math.pi * along) * math.exp(-0.7 * along)


def shift(t, start=4.0, length=0.7, size=-240.0):
    """Torque of an engine at the front axle [N m] for a moment."""
    return (size if start < t < start + length else 0.0), 0.0


def patch(x):
    """Stiffness and peak over those of the road [1] on 15 m of paint."""
    return (0.9, 0.6) if 160.0 < x < 175.0 else (1.0, 1.0)


PLANTS = {
    "bump": replace(REAL, bumps=bump),
    "gear shift": replace(REAL, motor=shift),
    "patch": replace(REAL, surface=patch),
}


def left_out(table):
    return [remark for remark in table.remarks if "left out from" in remark]


def pads(table):
    return table.calibration.pad_friction_f, table.calibration.pad_friction_r


@pytest.fixture(scope="module")
def usual():
    return fit(CAR, [noisy(ramp(REAL), 3)])


def test_nothing_is_left_out_of_a_ramp_in_which_nothing_happens(usual):
    assert left_out(usual) == []


@pytest.mark.parametrize(
    ("plant", "with_v"), [("bump", True), ("gear shift", True), ("patch", False)]
)
def test_a_disturbed_ramp_gives_the_pads_of_one_that_is_not(usual, plant, with_v):
    log = without(noisy(ramp(PLANTS[plant]), 3), *HIDDEN, *(() if with_v else ("v",)))
    table = fit(CAR, [log])
    assert len(left_out(table)) == 1
    for pad, true, undisturbed in zip(pads(table), TRUE, pads(usual), strict=True):
        assert pad.ci95[0] < true < pad.ci95[1]
        if with_v:
            width = undisturbed.ci95[1] - undisturbed.ci95[0]
            assert pad.value == pytest.approx(undisturbed.value, abs=0.25 * width)
            assert pad.ci95[1] - pad.ci95[0] < 1.2 * width


@pytest.mark.parametrize(("start", "code"), [(4.0, "begins"), (-9.0, "ends")])
def test_a_torque_that_stays_is_named(start, code):
    """Nobody knows which part of such a ramp is the usual one."""
    length = 99.0 if code == "begins" else 13.0
    plant = replace(REAL, motor=lambda t: shift(t, start, length))
    messages = messages_of(without(noisy(ramp(plant), 3), *HIDDEN))
    assert "force_step" in messages
    time = float(messages.split("the force changes at ")[1].split(" s,")[0])
    assert time == pytest.approx(4.0, abs=0.1)


def messages_of(log):
    """Return the warnings of a fit, or the message of the error if it refuses the log."""
    try:
        return "\n".join(map(str, fit(CAR, [log]).warnings))
    except LogError as error:
        return str(error)


def test_a_ramp_near_the_peak_of_the_tyres_is_used_to_its_top():
    """Eta rises steeply there, in few blocks: that is the tyre, no disturbance."""
    log = noisy(ramp(replace(REAL, surface=lambda x: (1.0, 0.72))), 0)
    table = fit(CAR, [log])
    assert left_out(table) == []
    assert table.quality["deceleration_max"] > 0.98 * float(np.max(log["a_x"])) / 9.81
