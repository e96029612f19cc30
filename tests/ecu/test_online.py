"""The estimator sample by sample, in Python and in C: what a whole log gives, and its life."""

from ctypes import addressof, c_char, c_double, c_void_p, create_string_buffer
from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import StoreError
from calib.base.names import WHEELS
from calib.car.effects.effects import Effects
from calib.ecu.native import Native, samples_of
from calib.ecu.online import RANGES, Online, require_plain
from calib.ecu.width import Width
from calib.estimation.estimator import estimate
from calib.estimation.reasons import Reason
from calib.help.samples import sample_logs
from calib.logs.read import read_log
from calib.table.exported import Precision, as_exported
from tests.support.compilers import needs_cc
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, WET, noisy, stop, without

pytestmark = needs_cc

STEP = 0.005
P_MC, A_X, FL, *_, STEERING, DRIVEN, _, _ = range(len(RANGES))
REASON, LEVEL, RATIO, FRONT, REAR, TORQUE_F, TORQUE_R, SUM = 0, *range(1, 22, 3)
DOUBLE = Width(64, Precision())


@pytest.fixture(scope="module")
def native(fitted):
    return Native(fitted, STEP, DOUBLE)


@pytest.fixture(scope="module")
def both(fitted, native):
    """Runs samples in Python and in C, which must agree, and returns the answers."""

    def run(samples):
        python, c = Online(fitted, STEP).run(samples), native.run(samples)
        assert np.array_equal(python[:, REASON], c[:, REASON])
        assert c == pytest.approx(python, rel=1e-9)
        assert np.isfinite(python).all()
        return python

    return run


@pytest.fixture(scope="module")
def drive_on():
    """A coast, a stop to 12 m/s, a release, and a second stop with other pads, on a plant."""

    def pressure(t):
        return 20e5 * (3.0 < t < 5.0) + 14e5 * (t > 7.5)

    def pads(t):
        return (0.38, 0.38) if t < 6.0 else (0.25, 0.25)

    run = drive(replace(REAL, pads=pads), pressure, 32.0, duration=10.0, rate=200.0, stop_speed=2.0)
    return noisy(as_log(run, "twice"), 3)


def test_a_log_gives_sample_by_sample_what_it_gives_as_a_whole(fitted, both):
    log = noisy(stop(WET), 5)
    told, e = both(samples_of(log)), estimate(fitted, without(log, "v"))
    assert np.array_equal(told[:, REASON], e.ecu.step.reason)
    late = log.time > log.time[0] + 0.05  # before the first block a log has the answer of it
    quantities = ("level", "ratio", "pads_f", "pads_r", "torque_f", "torque_r", "torque_sum")
    parts = [part[late] for of in quantities for part in getattr(e.ecu, of)]
    assert told[late, 1:] == pytest.approx(np.array(parts).T, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    "name", ["sedan/wet_tile_wet_pads.csv", "sedan/transition_dry_to_basalt.csv"]
)
@pytest.mark.parametrize("how", [Precision(), Precision(single=True), Precision(8, 16)])
def test_c_equals_python_as_the_table_is_exported(fitted, name, how):
    log, width = read_log(sample_logs() / name), Width.of(how)
    samples = width.rounded(samples_of(log))
    told = Native(fitted, log.sample_time, width).run(samples)
    right = Online(as_exported(fitted, how), log.sample_time).run(samples)
    near = 1e-9 if width.bits == 64 else 1e-4
    assert told == pytest.approx(right, rel=near)


def test_a_second_stop_with_other_pads(drive_on, both):
    told, time = both(samples_of(drive_on)), drive_on.time
    for at, true in ((4.9, 0.38), (9.4, 0.25)):
        i = np.searchsorted(time, at)
        assert told[i, REASON] == Reason.VALID
        assert told[i, FRONT + 1] < true < told[i, FRONT + 2]
        assert told[i, FRONT] == pytest.approx(true, rel=0.05)
        torque = CAR.front.torque_gain * true * drive_on["p_mc"][i]
        assert told[i, TORQUE_F] == pytest.approx(torque, rel=0.06)
    between = (time > 5.2) & (time < 7.4)
    assert set(told[between, REASON]) <= {Reason.NOT_BRAKED}


def test_a_reset_while_braking_answers_with_bounds_that_hold_the_pads(drive_on, both):
    told = both(samples_of(drive_on)[drive_on.time > 4.0])
    i = round(0.9 / STEP)
    assert told[i, REASON] == Reason.VALID
    assert told[i, FRONT + 1] < 0.38 < told[i, FRONT + 2]
    whole = both(samples_of(drive_on))[np.searchsorted(drive_on.time, 4.9)]
    reset, known = (x[RATIO + 2] / x[RATIO + 1] for x in (told[i], whole))
    assert reset > known  # without a coast eta has no zero


def spoiled(how, samples, time):
    """Samples with one of the mistakes of a bus."""
    wheels, out = slice(FL, FL + 4), samples.copy()
    at = int(np.searchsorted(time, 2.0))
    if how == "no number at first":
        out[time < 1.0, :6] = np.nan
    elif how == "nothing at first":
        out[time < 1.0, wheels] = 0.0
    elif how == "wheels drop out":
        out[(time > 3.5) & (time < 4.2), wheels] = np.nan
    elif how == "a wheel reads zero once":
        out[at, FL] = 0.0
    elif how == "wheels read double once":
        out[int(np.searchsorted(time, 4.0)), wheels] *= 2.0
    elif how == "a_x reads the range once":
        out[int(np.searchsorted(time, 4.0)), A_X] = -29.9
    return out


@pytest.mark.parametrize(
    "how",
    [
        *("no number at first", "nothing at first", "wheels drop out"),
        *("a wheel reads zero once", "wheels read double once", "a_x reads the range once"),
    ],
)
def test_a_mistake_of_the_bus_leaves_the_bounds_true(drive_on, both, how):
    told, time = both(spoiled(how, samples_of(drive_on), drive_on.time)), drive_on.time
    valid = (told[:, REASON] == Reason.VALID) & (time < 5.0)
    assert np.count_nonzero(valid) > 50
    for place in (FRONT, REAR):
        low, high = told[valid, place + 1], told[valid, place + 2]
        assert np.mean((low < 0.38) & (high > 0.38)) > 0.95
    assert Reason.FAULT in told[:, REASON]


def test_all_wheels_that_lock_at_once_are_seen_by_their_deceleration(drive_on, both):
    samples, time = samples_of(drive_on), drive_on.time
    locks = (time > 4.0) & (time < 4.5)
    left = np.clip(1.0 - (time[locks] - 4.0) / 0.15, 0.0, 1.0)
    samples[locks, FL : FL + 4] *= left[:, None]
    told = both(samples)
    assert set(told[(time > 4.1) & (time < 5.0), REASON]) <= {Reason.LOCKED, Reason.FAULT}


@pytest.mark.parametrize(
    ("channel", "value"),
    [(A_X, np.nan), (A_X, 99.0), (P_MC, -2e6), (FL, np.inf), (FL, -np.inf), (P_MC, np.nan)],
)
def test_a_sensor_that_fails_is_told_and_the_pads_stay(drive_on, both, channel, value):
    samples = samples_of(drive_on)
    fails = (drive_on.time > 4.2) & (drive_on.time < 4.5)
    samples[fails, channel] = value
    told = both(samples)
    assert set(told[fails, REASON]) == {Reason.FAULT}
    before, last = np.flatnonzero(fails)[[0, -1]] + (-1, 0)
    assert told[last, FRONT] == pytest.approx(told[before, FRONT], rel=0.02)
    assert told[np.searchsorted(drive_on.time, 4.9), REASON] == Reason.VALID


def test_an_accelerometer_that_is_frozen_is_told_once_the_pressure_moves(drive_on, both):
    samples = samples_of(drive_on)
    frozen = drive_on.time > 2.5
    samples[frozen, A_X] = samples[np.flatnonzero(frozen)[0], A_X]
    told = both(samples)
    assert set(told[(drive_on.time > 3.2) & (drive_on.time < 4.9), REASON]) == {Reason.FAULT}
    assert Reason.FAULT not in told[drive_on.time < 2.9, REASON]


def test_a_wheel_that_locks_counts_for_a_second_after_it(drive_on, both):
    samples = samples_of(drive_on)
    samples[(drive_on.time > 3.6) & (drive_on.time < 3.8), FL] *= 0.5
    told = both(samples)
    assert told[np.searchsorted(drive_on.time, 4.7), REASON] == Reason.LOCKED
    assert told[np.searchsorted(drive_on.time, 4.95), REASON] == Reason.VALID


def test_steering_standstill_and_reverse_have_their_reasons(drive_on, both):
    braked = samples_of(drive_on)
    braked[drive_on.time > 4.0, STEERING] = 0.2
    assert both(braked)[np.searchsorted(drive_on.time, 4.9), REASON] == Reason.TURNED
    rests = np.zeros((400, len(RANGES)))
    rests[100:, P_MC] = 10e5
    rests[250:, FL : FL + len(WHEELS)] = -5.0
    assert set(both(rests)[120:, REASON]) == {Reason.SLOW}


@pytest.fixture(scope="module")
def from_gas():
    """A coast, 0.04 g of thrust on the front axle until the brake is applied, and a stop."""

    def motor(t):
        return 0.04 * CAR.weight * CAR.front.rolling_radius * (1.5 < t < 4.0), 0.0

    def pressure(t):
        return 20e5 * min(max((t - 4.05) / 0.2, 0.0), 1.0)

    run = drive(replace(REAL, motor=motor), pressure, 28.0, duration=6.5)
    return noisy(as_log(run, "from gas"), 4)


def test_from_gas_to_brake_the_zeros_are_those_of_the_last_coasting(from_gas, both):
    samples = samples_of(without(from_gas, "T_drive_f", "T_drive_r"))
    unknown = both(samples)[-1]
    samples[(from_gas.time > 1.4) & (from_gas.time < 4.0), DRIVEN] = 1.0
    for known in (both(samples)[-1], both(samples_of(from_gas))[-1]):  # the pedal, the torque
        for place in (FRONT, REAR):
            assert known[place + 1] < 0.38 < known[place + 2]
        assert known[LEVEL] == pytest.approx(1.0, abs=0.02)
    assert unknown[LEVEL] > 1.04  # the thrust is taken for a zero of a_x


def test_calls_that_come_late_or_twice_leave_the_bounds_true(drive_on, both):
    """Every 30th sample is missing, every 37th is read twice: a task that jitters."""
    samples = samples_of(drive_on)
    rows = np.repeat(np.arange(len(samples)), 1 + (np.arange(len(samples)) % 37 == 36))
    rows = rows[rows % 30 != 29]
    told, time = both(samples[rows]), drive_on.time[rows]
    for at, true in ((4.9, 0.38), (9.4, 0.25)):
        i = np.searchsorted(time, at)
        assert told[i, REASON] == Reason.VALID
        assert told[i, FRONT + 1] < true < told[i, FRONT + 2]


def test_hours_without_a_brake_make_no_number_that_is_not_finite(drive_on, both):
    samples = samples_of(drive_on)
    coast = samples[drive_on.time < 2.9]
    told = both(np.concatenate([np.tile(coast, (30, 1)), samples[drive_on.time < 4.95]]))
    assert told[-1, REASON] == Reason.VALID
    assert told[-1, FRONT + 1] < 0.38 < told[-1, FRONT + 2]


def test_another_table_is_taken_at_rest_only(fitted, native):
    online = Online(fitted, STEP)
    rolls = dict.fromkeys(RANGES, 0.0) | {f"omega_{w}": 60.0 for w in WHEELS}
    online.step(rolls)
    assert not online.exchange(fitted)
    assert online.last == rolls
    for _ in range(2):  # the first one is a jump
        online.step(dict.fromkeys(RANGES, 0.0))
    assert online.exchange(fitted)
    assert not online.begun
    code, state, out = native.library, create_string_buffer(4096), create_string_buffer(1024)
    car = addressof(c_char.in_dll(code, "bte_this_car"))
    code.bte_init(state, c_void_p(car))
    for speed, taken in ((60.0, 0), (0.0, 1)):
        sample = (c_double * len(RANGES))(0.0, 0.0, *4 * [speed], *4 * [0.0])
        for _ in range(2):
            code.bte_step(state, sample, out)
        assert code.bte_exchange(state, c_void_p(car)) == taken


def test_a_car_with_an_effect_that_the_code_does_not_take_out_is_refused(fitted):
    late = Effects({"hydraulic_delay": {"delay": 0.1}})
    with pytest.raises(StoreError):
        require_plain(replace(fitted, vehicle=replace(CAR, effects=late)))
