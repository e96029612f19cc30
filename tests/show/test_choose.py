from dataclasses import replace
from pathlib import Path

import pytest

from calib.logs.read import read_log
from calib.show.choose import PlotInput, sheets
from calib.store.version import Stored
from tests.show.conftest import SEDAN


@pytest.fixture
def stored(sedan):
    return Stored(sedan, sedan.name, 1, sedan.digest, Path("tables"))


def kinds(**given):
    return [(s.kind, s.name) for s in sheets(PlotInput(**given))]


def test_a_table_alone_and_with_its_parents(stored, ramp):
    assert kinds(tables=(stored,)) == [("table", stored.id)]
    assert kinds(tables=(stored,), logs=(ramp,)) == [("table", stored.id)]
    (sheet,) = sheets(PlotInput(tables=(stored,), logs=(ramp,)))
    assert "forces" in sheet.names
    coast = read_log(SEDAN / "coast.csv")
    assert kinds(tables=(stored,), logs=(coast,)) == [("log", "coast")]


def test_another_log_is_a_stop_even_under_the_name_of_a_parent(stored, ramp, transition):
    assert kinds(tables=(stored,), logs=(transition,)) == [("stop", transition.name)]
    other = replace(transition, name=ramp.name)
    assert kinds(tables=(stored,), logs=(other,)) == [("stop", ramp.name)]
    assert kinds(tables=(stored,), logs=(transition, ramp)) == [
        ("table", stored.id),
        ("stop", transition.name),
    ]
