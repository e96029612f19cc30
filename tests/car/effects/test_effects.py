"""Effects as one value: what is joined, chosen and left out."""

from calib.car.effects.effects import Effects, EmpiricalTerm

DRAG = {"aerodynamic_drag": {"drag_area": 0.6}}
ROLLING = {"rolling_resistance": {"coefficient": 0.01}}
SIGMA = {"aerodynamic_drag": {"drag_area": 0.02}}
FADE = EmpiricalTerm("brakes", "temperature", (20.0, 300.0), (0.0, -0.1))
PULL = EmpiricalTerm("body", "constant", (0.0,), (0.01,))


def test_empty_it_is_false_and_a_term_alone_is_an_effect():
    assert not Effects()
    assert Effects(DRAG)
    assert Effects(terms=(PULL,))


def test_names_are_those_of_the_causes():
    effects = Effects(DRAG | ROLLING, (FADE,))
    assert effects.names == ("aerodynamic_drag", "rolling_resistance")
    assert "aerodynamic_drag" in effects
    assert "road_grade" not in effects
    assert effects.described == (*effects.names, "an empirical term on brakes over temperature")


def test_what_both_have_is_taken_from_the_other_with_its_sigma():
    one = Effects(DRAG | ROLLING, (FADE,), SIGMA)
    more = Effects({"aerodynamic_drag": {"drag_area": 0.8}})
    assert one.with_(more) == Effects({"aerodynamic_drag": {"drag_area": 0.8}} | ROLLING, (FADE,))
    assert more.with_(one) == one


def test_terms_of_the_other_replace_those_that_were_there():
    assert Effects(DRAG, (FADE,)).with_(Effects(terms=(PULL,))).terms == (PULL,)
    assert Effects(DRAG, (FADE,)).with_(Effects(ROLLING)).terms == (FADE,)


def test_chosen_by_name():
    effects = Effects(DRAG | ROLLING, (FADE,), SIGMA)
    assert effects.only("aerodynamic_drag") == Effects(DRAG, (), SIGMA)
    assert effects.without("aerodynamic_drag") == Effects(ROLLING, (FADE,))
    assert effects.without() == effects
