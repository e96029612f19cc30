import math

from calib.line.fleet.results import line_order


def test_numbers_in_names_count_as_numbers():
    assert line_order(["b2", "a10", "a9"]) == [2, 1, 0]


def test_what_is_not_known_goes_to_the_end_in_the_order_given():
    assert line_order([math.nan, 2.0, None, -1.0]) == [3, 1, 0, 2]
    assert line_order([True, None, False]) == [2, 0, 1]
