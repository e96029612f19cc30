"""The answer on a table: whether it is usable, and how far."""

import pytest

from calib.store.answer import answer, verdict
from calib.store.state import StateDecision
from calib.store.store import Store
from tests.support.tables import made_table


@pytest.mark.parametrize("word", ["draft", "released", "rejected", "withdrawn"])
def test_only_a_released_version_is_usable(store, word):
    stored = Store(store).save(made_table(), StateDecision(word, "made for a test"))
    found = answer(stored)
    assert found.usable == (word == "released")
    # the last row of the made table, at 0.30 g, is extrapolated
    assert found.decelerations == pytest.approx((0.0, 0.285))
    told = f"{found.decelerations[1]:.2f}\xa0g" in verdict(stored)
    assert told == (word in ("draft", "released"))
