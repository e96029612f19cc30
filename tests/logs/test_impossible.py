"""Samples that no car drives are marked, whatever a wheel does that a brake or a tyre can do."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.base.names import WHEELS
from calib.logs.impossible import without_impossible
from tests.support.made_runs import made_run, ramp
from tests.support.plant import drive, magic
from tests.support.reference_car import REAL

OMEGAS = [f"omega_{w}" for w in WHEELS]
ALL_CHANNELS = ["p_mc", "a_x", "v", *OMEGAS]


def with_error_value(names, value, first, count, rate=100.0):
    """A made run with ``value`` in ``count`` rows from ``first`` on; and the true channels."""
    log = made_run(ramp(rate=12.0), rate=rate, duration=5.0)
    channels = {name: x.copy() for name, x in log.channels.items()}
    for name in names:
        channels[name][first : first + count] = value
    return channels, log.channels


@pytest.mark.parametrize("rate", [40.0, 200.0, 1000.0])
@pytest.mark.parametrize(
    ("names", "value"),
    [
        (["omega_rl"], 0.0),
        (["omega_rl"], 327.675),  # 0xFFFF by 0.005 rad/s
        (["omega_rl"], -60.6),  # the raw 0 of a fault with the offset of -67.67 km/h of the signal
        (["omega_fr"], 511.97),  # 0x3FFF by 1/32
        (OMEGAS, 0.0),
        (ALL_CHANNELS, 0.0),
        (["v"], 0.0),
        (["v"], 182.0),  # 0xFFFF by 0.01 km/h
        (["p_mc"], 6.5535e7),
        (["p_mc"], 0.0),
        (["a_x"], -327.68),
    ],
)
def test_a_few_are_marked_and_bridged(names, value, rate):
    row, count = round(4.5 * rate), max(round(0.03 * rate), 1)  # at 36 bar, 22 m/s
    if names == ["p_mc"] and value == 0.0 and rate == 40.0:
        pytest.skip("a pedal that is let go may do that in 25 ms")
    channels, true = with_error_value(names, value, row, count, rate)
    cleaned, marked, _ = without_impossible(channels, "log")
    assert {m.channel: m.count for m in marked} == dict.fromkeys(names, count)
    for name in ALL_CHANNELS:
        elsewhere = np.delete(cleaned[name] - true[name], np.s_[row : row + count])
        assert not elsewhere.any()
        spread = np.ptp(true[name][row - count - 5 : row + count + 5])
        error = cleaned[name][row : row + count] - true[name][row : row + count]
        assert np.max(np.abs(error)) <= spread


@pytest.mark.parametrize(("first", "count"), [(0, 1), (0, 26), (499, 1), (480, 20)])
def test_at_the_ends_they_are_left_open(first, count):
    channels, _ = with_error_value(ALL_CHANNELS, 0.0, first, count)
    cleaned, _, _ = without_impossible(channels, "log")
    for name in ALL_CHANNELS:
        rows = np.flatnonzero(np.isnan(cleaned[name]))
        assert rows.tolist() == list(range(first, first + count))


@pytest.mark.parametrize("rows", [slice(100, 140), slice(250, None), slice(50, None, 20)])
def test_many_are_refused(rows):
    channels, _ = with_error_value([], 0.0, 0, 0)
    channels["omega_rr"][rows] = 0.0
    with pytest.raises(LogError) as error:
        without_impossible(channels, "log")
    assert str(error.value.where) == "log: omega_rr"


def test_a_speed_without_satellites_at_first_is_left_open():
    channels, _ = with_error_value(["v"], 0.0, 0, 200)
    cleaned, _, _ = without_impossible(channels, "log")
    assert np.isnan(cleaned["v"]).sum() == 200


@pytest.mark.parametrize("rate", [40.0, 1000.0])
def test_wheels_that_lock_and_spin_up_again_are_possible(rate):
    ice = replace(REAL, tyre=magic(20.0, 0.12))
    run = drive(ice, lambda t: 6e6 if t % 1.0 > 0.5 else 0.0, 25.0, duration=2.5, rate=rate)
    assert min(run[name].min() for name in OMEGAS) < 0.1  # they do lock
    assert not without_impossible(run, "log")[1]


def test_cycles_of_abs_in_slow_messages_are_possible():
    """The wheel loses 40 % within 20 ms, in a log of 200 Hz that holds messages of 50 Hz."""
    channels, _ = with_error_value([], 0.0, 0, 0, rate=200.0)
    slow = np.where(np.arange(1000) % 40 < 20, 1.0, 0.6)
    channels["omega_fl"][600:] *= slow[600:]
    assert not without_impossible(channels, "log")[1]
