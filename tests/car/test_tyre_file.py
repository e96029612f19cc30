"""Tyre property files: the formula against closed forms, and files that are refused."""

import hashlib
import math

import numpy as np
import pytest

from calib.base.errors import TyreError
from calib.car.tyre import MagicFormula
from calib.car.tyre_file import read_tyres
from tests.support.refusals import refusal
from tests.support.tyre_files import KEYS, written

RADIUS = {"UNLOADED_RADIUS": 0.33, "VERTICAL_STIFFNESS": 2.1e5, "BREFF": 8.4, "DREFF": 0.27,
          "FREFF": 0.07}  # fmt: skip


@pytest.fixture
def path(tmp_path):
    return tmp_path / "tyre.tir"


def read(path, **changed):
    return read_tyres([written(path, **changed)])[0]


def test_stiffness_and_peak_over_load(path):
    tyre = read(path, PKX2=1.5, PKX3=0.2, PDX2=-0.1, LKX=0.9, LMUX=0.8, LFZO=0.5)
    assert tyre.at_load(2150.0) == pytest.approx((25.0 * 0.9, 0.9 * 0.8))
    stiffness, peak = tyre.at_load(2150.0 * 1.2)
    assert stiffness == pytest.approx((25.0 + 0.3) * math.exp(0.04) * 0.9)
    assert peak == pytest.approx((0.9 - 0.02) * 0.8)
    assert (tyre.name, tyre.digest) == ("tyre", hashlib.sha256(path.read_bytes()).hexdigest())


def test_without_curvature_it_is_the_formula_of_the_car(path):
    force, slip = read(path).curve(4300.0)
    formula = MagicFormula(stiffness=1.0, peak=1.0, shape=KEYS["PCX1"])
    np.testing.assert_allclose(formula.force(slip), force, atol=1e-12)
    assert force[-1] == pytest.approx(1.0, abs=1e-4)


def test_curvature_of_braking(path):
    """E = (0.4 - 0.1) (1 + 0.05) at half of the load more; the slip solves the formula."""
    force, slip = read(path, PEX1=0.4, PEX2=-0.2, PEX4=0.05).curve(6450.0)
    x, E = slip / 1.65, 0.3 * 1.05
    np.testing.assert_allclose(
        np.sin(1.65 * np.arctan((1.0 - E) * x + E * np.arctan(x))), force, atol=1e-12
    )


def test_fall_of_the_rolling_radius(path):
    """The slope of the effective radius over the load, by differences."""
    tyre, load = read(path, **RADIUS), 4000.0

    def radius(F):
        r = F / KEYS["FNOMIN"]
        sunk = RADIUS["DREFF"] * np.arctan(RADIUS["BREFF"] * r) + RADIUS["FREFF"] * r
        return RADIUS["UNLOADED_RADIUS"] - KEYS["FNOMIN"] / RADIUS["VERTICAL_STIFFNESS"] * sunk

    slope = (radius(load + 1.0) - radius(load - 1.0)) / 2.0
    assert tyre.radius_load(load) == pytest.approx(-slope * load / 0.33, rel=1e-4)
    assert read(path).radius_load(load) is None


@pytest.mark.parametrize(
    ("changed", "names"),
    [
        ({"PKX1": None}, "PKX1"),
        ({"FNOMIN": None, "PCX1": None}, "PCX1"),
        ({"force": "kilogram_force"}, "FORCE"),
        ({"PDX1": 90.0}, "PDX1"),
        ({"PKX1": "-25"}, "PKX1"),
        ({"PEX1": "none"}, "PEX1"),
        ({"LKX": "nan"}, "LKX"),
        ({"FNOMIN": 4.3}, "FNOMIN"),
        ({"LFZO": 0.0}, "LFZO"),
    ],
)
def test_files_that_are_refused(path, changed, names):
    message = refusal(read_tyres, [written(path, **changed)], kind=TyreError, names=path)
    assert names in message
    assert "expected" in message


def test_no_tyre_file_at_all(path):
    refusal(read_tyres, [path], kind=TyreError, names=path)
    path.write_bytes(bytes(range(256)))
    assert "PKX3" in refusal(read_tyres, [path], kind=TyreError, names=path)
    refusal(read_tyres, [path] * 3, kind=TyreError)


def test_a_tyre_of_another_vehicle(path):
    tyre = read(path, FNOMIN=20000.0)
    refusal(tyre.at_load, 4300.0, kind=TyreError, names=path)
