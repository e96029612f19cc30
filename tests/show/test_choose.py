from dataclasses import replace
from pathlib import Path

import pytest

from calib.logs.read import read_log
from calib.show.choose import PlotInput, sheets
from calib.store.version import Stored
from tests.show.conftest import SEDAN, SIMULATION
from tests.support.stored_results import made_result


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


def test_truth_makes_it_a_simulation(stored):
    run = read_log(SIMULATION / "stop_noisy.parquet")
    assert kinds(tables=(stored,), logs=(run,)) == [("simulation", "stop_noisy")]


def test_two_tables_are_compared(stored):
    other = replace(stored, version=2)
    assert kinds(tables=(stored, other)) == [("comparison", f"{stored.id}_{other.id}")]


def test_a_log_or_a_result_alone(ramp):
    assert kinds(logs=(ramp,)) == [("log", ramp.name)]
    assert kinds(results=(made_result(),)) == [("stop", "stop")]


def test_too_many_tables_are_an_error(stored, ramp):
    for given in ({"tables": (stored,) * 3}, {"tables": (stored,) * 2, "logs": (ramp,)}):
        with pytest.raises(ValueError, match="two tables are drawn without logs"):
            kinds(**given)
