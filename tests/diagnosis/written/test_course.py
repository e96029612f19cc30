"""What each step of a search changed."""

from calib.diagnosis.proof.prove import SearchStep
from calib.diagnosis.written.course import changes


def test_each_step_is_told_against_the_one_before():
    one, two = changes(
        (
            SearchStep((), 4.0, 8.0),
            SearchStep(("a", "b"), 1.5, 2.0),
            SearchStep(("b", "c"), 1.0, 2.25),
        )
    )
    assert (one.added, one.removed, one.gain, one.fall) == (("a", "b"), (), 2.5, 6.0)
    assert (two.added, two.removed, two.gain, two.fall) == (("c",), ("a",), 0.5, -0.25)


def test_a_search_that_added_nothing_changed_nothing():
    assert changes((SearchStep((), 4.0, 8.0),)) == []
