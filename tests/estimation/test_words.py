"""A validation in words, against stops whose pads are known because they were made so."""

import re
from dataclasses import replace

import pytest

from calib.estimation.limits import Limit
from calib.estimation.validate import validate
from calib.estimation.words import conclusion, lines
from tests.support.reference_car import REAL, WET, noisy, ramp, stop, with_pads
from tests.support.tables import stored_as


@pytest.fixture(scope="module")
def told(fitted):
    """The words on a stop with pads that are this share of those of the ramp."""

    def of(front, rear):
        model = with_pads(WET, 0.38 * front, 0.38 * rear)
        (result,) = validate(fitted, [replace(noisy(stop(model), 3), name="stop")])
        return lines(result)

    return of


def test_pads_as_they_were(told):
    first, second = told(1.0, 1.0)
    assert re.fullmatch(
        r"stop: passed: pads within \d % of those of the ramp, front and rear alike \(.*\)", first
    )
    assert re.fullmatch(
        r"stop: their friction is known to \d+ % front and \d+ % rear; "
        r"the torque is off the truth by .*; \d+ % of the braking is valid",
        second,
    )


def test_pads_that_lost_alike(told):
    first, *_ = told(0.8, 0.8)
    found = re.search(
        r"pads (\d+) \+- (\d+) % below those of the ramp, front and rear alike", first
    )
    assert abs(int(found[1]) - 20) <= int(found[2]) + 1


def test_pads_that_lost_unlike(told):
    first, *_ = told(0.7, 1.0)
    found = re.search(r"front pads (\d+) \+- (\d+) % below, rear pads .* those of the ramp", first)
    assert abs(int(found[1]) - 30) <= int(found[2]) + 1
    assert "alike" not in first


def test_a_limit_that_is_not_held_is_named_by_its_meaning(fitted):
    held = (Limit("interval_f", None, 0.01), Limit("valid_share", 0.999, None))
    (result,) = validate(fitted, [noisy(stop(WET), 3)], limits=held)
    *_, last = lines(result)
    assert "half width of the 95 % interval, front, relative is 0.0" in last
    assert ", at most 0.01; share of valid samples" in last
    assert last.endswith("at least 0.999")


def test_a_required_figure_that_is_not_known_is_told(fitted):
    log = noisy(stop(WET), 3)
    bare = replace(log, truth={})
    (result,) = validate(
        fitted, [bare], limits=(Limit("torque_error_f", None, None, required=True),)
    )
    assert lines(result)[-1].endswith(" is not known, and it is required")


def test_the_conclusion_and_what_comes_next(fitted):
    stop_, run = noisy(stop(WET), 3), noisy(ramp(REAL), 1)
    results = validate(fitted, [stop_, run])
    draft = stored_as("sedan@1")
    assert "`brake-cal tables release" in conclusion(draft, results[:1])
    assert conclusion(draft, results).startswith("failed: 1 of 2 logs is within the limits; next:")
    assert "without the logs of the fit" in conclusion(draft, results)
    assert lines(results[1])[0].endswith("it is no hold-out and proves nothing")


def test_stops_with_other_pads_do_not_send_to_a_release(fitted):
    """Front pads of one stop are at 60 %: within the limits, and no proof of the table."""
    models = (WET, with_pads(WET, 0.38 * 0.6, 0.38))
    results = validate(
        fitted,
        [replace(noisy(stop(model), 3 + i), name=f"stop_{i}") for i, model in enumerate(models)],
    )
    draft = stored_as("sedan@1")
    assert all(result.passed for result in results)
    text = conclusion(draft, results)
    assert text.startswith("passed: all 2 logs are within the limits")
    assert "find out why the pads differ" in text
    assert "tables release" not in text
    assert any(result.all_warnings for result in results)
    warned = [result for result in results if result.all_warnings]
    assert "next: look at the warnings; where they do not speak" in conclusion(draft, warned[:1])
