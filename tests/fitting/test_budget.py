"""What a table's pads rest on: the parts add up, and each is the error that its cause makes."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.car.beliefs import LOG
from calib.car.effects.effects import Effects
from calib.fitting.fit import fit
from calib.fitting.pads import level_of
from calib.run.accelerometer import Accelerometer
from calib.run.resistance import Resistance
from tests.support.reference_car import CAR, REAL, noisy, prepared, ramp, without

UNWEIGHED = replace(CAR, mass_tolerance=0.03)
EFFECTS = Effects(
    {"aerodynamic_drag": {"drag_area": 0.66}, "rolling_resistance": {"coefficient": 0.011}}
)
SURE = Resistance(EFFECTS, ((0.0, 0.0), (0.0, 0.0)), specified=True)


@pytest.fixture(scope="module")
def clean():
    return ramp(REAL)


@pytest.fixture(scope="module")
def tables(clean):
    """With v and without."""
    log = noisy(clean, 1)
    return fit(UNWEIGHED, [log]), fit(UNWEIGHED, [without(log, "v")])


def test_parts_add_up_to_the_sigmas(tables):
    for table in tables:
        cal, budget = table.calibration, table.budget
        for parts, value in zip(
            budget.axles, (cal.pad_friction_f, cal.pad_friction_r), strict=True
        ):
            sigma = math.hypot(*parts.values())
            assert sigma == pytest.approx(value.sigma / value.value, rel=1e-9)
        stiffness = cal.slip_stiffness.sigma / cal.slip_stiffness.value
        pairs = (budget.ratio, cal.pad_log_ratio.sigma), (budget.stiffness, stiffness)
        for parts, sigma in pairs:
            assert sum(parts.values()) == pytest.approx(sigma**2, rel=1e-9)
            assert min(parts.values()) >= 0.0


def moved(right, wrong):
    """Return the change of ln of the pad friction of front and rear axle."""
    pads = [(t.calibration.pad_friction_f, t.calibration.pad_friction_r) for t in (right, wrong)]
    return [math.log(b.value / a.value) for a, b in zip(*pads, strict=True)]


def test_a_wrong_mass_moves_the_pads_by_the_part_of_the_mass(clean):
    """A plant 3 % heavier than its file, at one sigma of a mass that nobody wrote down.

    Its drag is the same, 6 % of the force that slows it, so the pads move by 6 % less.
    """
    heavy = ramp(replace(REAL, mass_scale=1.03))
    tables = [fit(UNWEIGHED, [noisy(log, 1)]) for log in (clean, heavy)]
    for parts, error in zip(tables[0].budget.axles, moved(*tables), strict=True):
        assert abs(error) == pytest.approx(parts["mass"], rel=0.1)


def test_a_wrong_scale_of_the_accelerometer_moves_the_pads_by_its_part(clean, tables):
    """Without v it shows nowhere: a scale of one sigma moves them by the part.

    What is read on the lead-in is scaled too, and half believed to be a resistance.
    """
    off = LOG.a_x_scale.sigma
    log = noisy(clean, 1)
    scaled = replace(log, channels={**log.channels, "a_x": (1.0 + off) * log["a_x"]})
    wrong = fit(UNWEIGHED, [without(scaled, "v")])
    for parts, error in zip(tables[1].budget.axles, moved(tables[1], wrong), strict=True):
        assert error == pytest.approx(off, rel=0.2)
        assert parts["accelerometer"] == pytest.approx(off, rel=0.01)


def sensed(scale=0.0, bias=0.0, together=0.0):
    """An accelerometer with these variances."""
    return Accelerometer(0.0, 0.0, scale, bias, together, *np.zeros(3))


def test_level_parts_in_closed_form(clean):
    run = prepared(noisy(clean, 1), effects=EFFECTS)
    braked = run.use & ~run.blocks.lead_in
    lead = run.blocks.lead_in & run.use
    z = run.blocks.z[braked]
    lever = z.sum() / (z @ z)
    car = replace(CAR, mass_tolerance=0.02)

    def parts(resistance=SURE, **variances):
        sensor = sensed(**variances)
        return level_of(car, [replace(run, accelerometer=sensor)], resistance, 0.0)[1]

    alone = parts()
    assert alone["mass"] == pytest.approx(4e-4)
    assert alone["accelerometer"] == alone["resistance"] == 0.0
    density = run.noise.z**2 / run.blocks.length
    assert alone["noise"] == pytest.approx(density * (1.0 / (z @ z) + lever**2 / lead.sum()))
    assert parts(scale=1e-4, bias=1e-6, together=-5e-6)["accelerometer"] == pytest.approx(1e-4)
    rolling = Resistance(EFFECTS, ((0.0, 0.0), (0.0, 1e-6)))
    assert parts(resistance=rolling)["resistance"] == pytest.approx(1e-6 * lever**2)
    # an identified resistance includes the noise of the lead-in
    assert parts(resistance=rolling)["noise"] == pytest.approx(density / (z @ z))


def test_a_mass_that_is_known_has_no_part_and_moves_no_other(clean, tables):
    weighed = fit(replace(CAR, mass_tolerance=0.0), [noisy(clean, 1)])
    for parts, unknown in zip(weighed.budget.axles, tables[0].budget.axles, strict=True):
        assert "mass" not in parts
        others = {part: x for part, x in unknown.items() if part != "mass"}
        assert parts == pytest.approx(others, rel=1e-6)
