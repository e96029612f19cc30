"""Which versions may be merged, and what is said of those that may not."""

from dataclasses import replace

import pytest

from calib.base.errors import RevisionError
from calib.store.merge import merge
from calib.store.parents import require_mergeable
from calib.store.state import VersionState
from calib.table.by_hand import SetByHand
from tests.support.cars_of_a_line import car_table, cars, version

PAIR = cars(26.0, 28.0)


def of_second(**changes):
    """The pair with the second table changed."""
    second = replace(PAIR[1].table, **changes)
    return [PAIR[0], version(second, 2)]


def of_provenance(**changes):
    return of_second(provenance=replace(PAIR[1].table.provenance, **changes))


def of_vehicle(**changes):
    return of_second(vehicle=replace(PAIR[1].table.vehicle, **changes))


def test_two_cars_of_one_model_may_be_merged():
    require_mergeable(PAIR, "golden")
    require_mergeable(of_vehicle(name="another name", mass_tolerance=0.005, motor_odds=0), "golden")


FRONT = PAIR[1].table.vehicle.front
GOLDEN = version(merge(PAIR, "golden"), 1)
BY_HAND = (SetByHand("pad_friction_f", 0.38, 0.39, "bench"),)


@pytest.mark.parametrize(
    ("parents", "says"),
    [
        ([], "a mean needs two cars or more, 0 was given"),
        (PAIR[:1], "a mean needs two cars or more, 1 was given"),
        ([PAIR[0], PAIR[0]], "sedan@1 was given twice"),
        ([PAIR[0], version(PAIR[0].table, 7)], "sedan@1 and sedan@7 are the same"),
        (of_provenance(logs=PAIR[0].table.provenance.logs), "made of the same ramp ramp_1.csv"),
        (of_provenance(identity={"serial": "S1"}), r"are of one car \(serial S1\)"),
        (of_vehicle(mass=1750.0), "different vehicles: mass 1744 and 1750"),
        (of_vehicle(cg_height=0.6), "different vehicles: cg_height 0.615 and 0.6"),
        (of_vehicle(front=replace(FRONT, piston_area=3e-3)), "front.piston_area 0.002884 and"),
        (of_vehicle(front=replace(FRONT, pad_friction=0.4)), "front.pad_friction 0.38 and 0.4"),
        (of_second(by_hand=BY_HAND), "sedan@2 was corrected by hand and is no measurement"),
        ([GOLDEN, *cars(1.0, 2.0, 27.0)[2:]], "golden@1 is a mean of cars itself"),
    ],
)
def test_what_has_no_mean_is_refused_in_plain_words(parents, says):
    with pytest.raises(RevisionError, match=says) as error:
        require_mergeable(parents, "mean")
    assert error.value.exit_code == 2


def test_the_vin_tells_a_car_too():
    one, two = (
        version(replace(t, provenance=replace(t.provenance, identity={"vin": "W1"})), n)
        for n, t in ((1, car_table(1)), (2, car_table(2, 28.0)))
    )
    with pytest.raises(RevisionError, match=r"one car \(vin W1\)"):
        require_mergeable([one, two], "golden")


def test_the_mean_is_no_version_of_a_car():
    with pytest.raises(RevisionError, match="next version of a car's table"):
        require_mergeable(PAIR, "sedan")


def test_a_table_of_less_than_half_of_the_range_is_left_out():
    d = PAIR[1].table.difference
    short = replace(d, **{name: getattr(d, name)[:8] for name in vars(d)})
    with pytest.raises(RevisionError, match=r"sedan@2 ends at eta 1\.00175, less than half"):
        require_mergeable(of_second(difference=short), "golden")


def test_all_reasons_come_at_once():
    parents = of_vehicle(mass=1750.0)
    with pytest.raises(RevisionError) as error:
        require_mergeable([*parents, parents[1]], "sedan")
    assert "different vehicles" in str(error.value)
    assert "given twice" in str(error.value)
    assert "another name" in str(error.value)


@pytest.mark.parametrize("word", ["rejected", "withdrawn"])
def test_a_car_that_may_not_be_used_is_no_part_of_a_mean(word):
    second = replace(PAIR[1], state=VersionState(word, reason="front pads wet"))
    with pytest.raises(RevisionError, match=f"is {word}: front pads wet; leave it out"):
        merge([PAIR[0], second], "golden")
