"""Exchanged columns of one front and one rear wheel, on an independent plant and in closed form."""

from dataclasses import replace

import numpy as np
import pytest

from calib.run.crossed_wheels import crossed_diagonal, crossed_side, wheel_parts
from calib.run.driving_record import driving_record
from calib.run.observation import observe
from calib.run.rules import PURPOSES, problems
from tests.studies.made_lines import PAIRS, exchanged, in_bend, line, recorded, with_brakes
from tests.support.made_runs import SLIP_F, SLIP_R, made_run, stop

LEVEL = 20.0
RUN = made_run(stop(level=LEVEL), name="stop")


def parts_of(log):
    return wheel_parts(log, driving_record(log))


def test_the_three_parts_of_a_closed_form():
    """Slips of 1.2 % per g in front and 0.7 % behind, left and right alike."""
    parts = parts_of(RUN)
    z = LEVEL / 70.0
    assert parts.axles.value == pytest.approx((SLIP_F - SLIP_R) * z, rel=0.03)
    assert abs(parts.sides.value) < 3.0 * parts.sides.half
    assert abs(parts.diagonals.value) < 3.0 * parts.diagonals.half
    assert parts.z == pytest.approx(z, rel=0.1)


@pytest.fixture(scope="module")
def car():
    return line(np.random.default_rng(4), 4)


@pytest.fixture(scope="module")
def plain(car):
    return recorded("stop_1", car.runs["stop_1"], car.sensors)


@pytest.mark.parametrize("pair", PAIRS, ids="-".join)
def test_each_pair_is_named(plain, pair):
    expected = parts_of(plain).axles.value
    log = exchanged(plain, pair)
    side, diagonal = crossed_side(parts_of(log)), crossed_diagonal(parts_of(log), expected)
    of_one_side = pair[0][1] == pair[1][1]
    found, other = (side, diagonal) if of_one_side else (diagonal, side)
    assert found.wheels == pair
    assert other is None


def test_one_side_is_refused_for_every_purpose(plain):
    seen = observe(exchanged(plain, ("fr", "rr")))
    for purpose in PURPOSES:
        reasons = problems(seen, purpose)
        assert any("omega_fr and omega_rr have changed places" in one for one in reasons)


@pytest.mark.parametrize("kind", ["plain", "bend", "weak caliper", "uneven brakes", "small wheel"])
def test_what_looks_like_it_is_not_named(car, plain, kind):
    run, expected = car.runs["stop_1"], parts_of(plain).axles.value
    log = {
        "plain": lambda: plain,
        "bend": lambda: recorded("stop_1", in_bend(run, 150.0, 1.5), car.sensors),
        "weak caliper": lambda: recorded("stop_1", with_brakes(run, fl=0.5), car.sensors),
        "uneven brakes": lambda: recorded("stop_1", with_brakes(run, fl=1.1, rr=1.1), car.sensors),
        "small wheel": lambda: replace(
            plain, channels={**plain.channels, "omega_rl": 1.01 * plain["omega_rl"]}
        ),
    }[kind]()
    assert crossed_side(parts_of(log)) is None
    assert crossed_diagonal(parts_of(log), expected) is None
