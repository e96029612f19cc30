"""Use of a version by its state, and the intervals of effects within the range of the card."""

from dataclasses import replace

import pytest

from calib.car.effects.effects import Effects
from calib.store.figures import effect_figures, usability, verdict
from calib.store.state import StateDecision
from tests.support.tables import made_table


def with_drag(value, sigma):
    effects = Effects(
        {"aerodynamic_drag": {"drag_area": value}}, sigma={"aerodynamic_drag": {"drag_area": sigma}}
    )
    return replace(made_table(), effects=effects)


def test_an_interval_within_the_range_of_the_card_is_that_of_the_sigma():
    (figure,) = effect_figures(with_drag(0.66, 0.1))
    assert figure.ci95 == pytest.approx((0.464, 0.856), abs=1e-4)
    assert figure.unit == "m^2"
    assert str(figure) == "drag_area 0.66 m^2 (95 %: 0.464 to 0.856)"
    (zero,) = effect_figures(with_drag(0.0, 0.1))
    assert zero.ci95 == pytest.approx((0.0, 0.196), abs=1e-4)  # no drag is negative
    (exact,) = effect_figures(with_drag(0.66, 0.0))
    assert str(exact) == "drag_area 0.66 m^2 (given)"


@pytest.mark.parametrize("word", ["draft", "released", "rejected", "withdrawn"])
def test_only_a_released_version_is_usable(store, word):
    stored = store.save(made_table(), StateDecision(word, "made for a test"))
    use = usability(stored)
    assert use.usable == (word == "released")
    # the last row of the made table, at 0.30 g, is extrapolated
    assert use.decelerations == pytest.approx((0.0, 0.285))
    names_the_range = f"{use.decelerations[1]:.2f}\xa0g" in verdict(stored)
    assert names_the_range == (word in ("draft", "released"))
