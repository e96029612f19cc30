from dataclasses import replace
from pathlib import Path

import pytest

from calib.logs.read import read_log
from calib.show.choose import sheets
from calib.store.version import Stored
from tests.show.conftest import SEDAN


@pytest.fixture
def stored(sedan):
    return Stored(sedan, sedan.name, 1, sedan.digest, Path("tables"))


def kinds(*arguments):
    return [(sheet.kind, sheet.name) for sheet in sheets(*arguments)]


def test_logs_of_a_fit_are_drawn_with_their_table(stored, ramp):
    assert kinds(stored, []) == [("table", stored.id)]
    assert kinds(stored, [ramp]) == [("table", stored.id)]
    assert kinds(stored, [read_log(SEDAN / "coast.csv")]) == [("log", "coast")]


def test_another_log_is_a_stop_even_under_the_name_of_a_parent(stored, ramp, transition):
    assert kinds(stored, (transition,)) == [("stop", transition.name)]
    other = replace(transition, name=ramp.name)
    assert kinds(stored, (other,)) == [("stop", ramp.name)]
    assert kinds(stored, (transition, ramp)) == [("table", stored.id), ("stop", transition.name)]
