"""What is left beside a name is told as it is seen: in the replays, or in single steps alone."""

from dataclasses import replace

from calib.diagnosis.written.words import something_else
from tests.support.written_diagnosis import LEFT, QUIET, named_drag, unknown


def beside(left):
    named = named_drag()
    return replace(named, unexplained=unknown(named).unexplained, left=left)


def test_replays_that_do_not_show_it_are_not_called_large():
    told = something_else(beside(QUIET))
    assert told.startswith("Something else is left")
    assert "The replays of the hold-outs do not show it" in told
    assert "It is largest in" not in told


def test_replays_that_show_it_say_where():
    told = something_else(beside(LEFT))
    assert "standard deviations or more from noise alone" in told
    assert f"It is largest in {LEFT.channel} of {LEFT.log}" in told
