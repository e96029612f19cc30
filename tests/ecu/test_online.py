"""The estimator sample by sample, in Python and in C: what a whole log gives, and its life."""

from ctypes import addressof, c_char, c_double, c_void_p, create_string_buffer
from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import StoreError
from calib.car.effects.effects import Effects
from calib.ecu.channels import A_X, CHANNELS, DRIVEN, FL, OMEGA, P_MC, STEERING, samples_of
from calib.ecu.native import Native
from calib.ecu.online import Online, require_plain
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
REASON, LEVEL, RATIO, FRONT, REAR, TORQUE_F, *_ = 0, *range(1, 22, 3)
VALID, FAULT, LOCKED = {Reason.VALID}, {Reason.FAULT}, {Reason.LOCKED}


@pytest.fixture(scope="module")
def native(fitted):
    return Native(fitted, STEP, Precision())


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
    log = read_log(sample_logs() / name)
    samples = how.computed(samples_of(log))
    told = Native(fitted, log.sample_time, how).run(samples)
    right = Online(as_exported(fitted, how), log.sample_time).run(samples)
    near = 1e-9 if how.floating == 64 else 1e-4
    assert told == pytest.approx(right, rel=near)


def put(begin, end, channels, value):
    """Makes readings ``value`` between two times; a function gets them with their times."""

    def spoil(x, t):
        at = (t > begin) & (t < end)
        x[at, channels] = value(x[at, channels], t[at]) if callable(value) else value
        return x, t

    return spoil


def locking(x, t):
    return x * np.clip(1.0 - (t - 4.0) / 0.15, 0.0, 1.0)[:, None]


def jittering(x, t):
    """Every 30th sample is missing, every 37th is read twice."""
    rows = np.repeat(np.arange(len(t)), 1 + (np.arange(len(t)) % 37 == 36))
    rows = rows[rows % 30 != 29]
    return x[rows], t[rows]


def coasting(x, t):
    """A minute and a half of coasting before it."""
    coast = np.tile(x[t < 2.9], (30, 1))
    return np.vstack([coast, x]), STEP * (np.arange(len(coast) + len(x)) - len(coast))


ONCE, BITE = (3.999, 4.001), (4.2, 4.5)
LIFE = {
    "two stops": (put(0, 0, P_MC, 0), {(5.2, 7.4): {Reason.NOT_BRAKED}}),
    "reset while braking": (lambda x, t: (x[t > 4.0], t[t > 4.0]), {}),
    "calls that come late or twice": (jittering, {}),
    "a long coast": (coasting, {}),
    "no number at first": (put(-1, 1, slice(6), np.nan), {(-1, 1): FAULT}),
    "nothing at first": (put(-1, 1, OMEGA, 0), {(0.999, 1.001): FAULT}),
    "wheels drop out": (put(3.5, 4.2, OMEGA, np.nan), {(3.5, 4.2): FAULT}),
    "a wheel reads zero once": (put(1.999, 2.001, FL, 0), {(1.999, 2.001): FAULT}),
    "wheels read double once": (put(*ONCE, OMEGA, lambda x, t: 2.0 * x), {ONCE: FAULT}),
    "a_x reads the range once": (put(*ONCE, A_X, -29.9), {ONCE: FAULT}),
    "a_x no number": (put(*BITE, A_X, np.nan), {BITE: FAULT}),
    "a_x out of range": (put(*BITE, A_X, 99.0), {BITE: FAULT}),
    "pressure out of range": (put(*BITE, P_MC, -2e6), {BITE: FAULT}),
    "pressure no number": (put(*BITE, P_MC, np.nan), {BITE: FAULT}),
    "wheel infinite": (put(*BITE, FL, np.inf), {BITE: FAULT}),
    "wheel minus infinite": (put(*BITE, FL, -np.inf), {BITE: FAULT}),
    "a_x is frozen once the pressure moves": (
        put(2.5, 99, A_X, lambda x, t: x[0]), {(3.2, 4.9): FAULT, (0, 2.9): {Reason.NOT_BRAKED}},
    ),
    "a wheel locks, and for 1 s after": (
        put(3.6, 3.8, FL, lambda x, t: 0.5 * x), {(3.9, 4.79): LOCKED, (4.9, 4.99): VALID},
    ),
    "all wheels lock at once": (put(4, 4.5, OMEGA, locking), {(4.1, 5.0): LOCKED | FAULT}),
    "steered": (put(4, 5, STEERING, 0.2), {(4.1, 5.0): {Reason.TURNED}}),
}  # fmt: skip
"""What happens to the samples of `drive_on`; the reasons that are told between two times [s]."""
SPOILT = {*list(LIFE)[-4:]}
"""Of which nothing is known at the end of the first stop."""


@pytest.fixture(scope="module")
def drive_on():
    """A coast, a stop to 12 m/s, a release, and a second stop with other pads, on a plant."""

    def pressure(t):
        return 20e5 * (3.0 < t < 5.0) + 14e5 * (t > 7.5)

    def pads(t):
        return (0.38, 0.38) if t < 6.0 else (0.25, 0.25)

    run = drive(replace(REAL, pads=pads), pressure, 32.0, duration=10.0, rate=200.0, stop_speed=2.0)
    return noisy(as_log(run, "twice"), 3)


@pytest.mark.parametrize("what", LIFE)
def test_whatever_happens_a_valid_answer_has_the_pads_in_its_bounds(what, drive_on, both):
    spoil, expected = LIFE[what]
    x, time = spoil(samples_of(drive_on), drive_on.time.copy())
    told = both(x)
    for (begin, end), reasons in expected.items():
        found = set(told[(time > begin) & (time < end), REASON])
        assert found
        assert found <= reasons
    for first, last, true in ((3.0, 5.0, 0.38), (7.5, 10.0, 0.25)):
        valid = (told[:, REASON] == Reason.VALID) & (time > first) & (time < last)
        for place in (FRONT, REAR):
            low, high = told[valid, place + 1], told[valid, place + 2]
            assert not valid.any() or np.mean((low < true) & (high > true)) > 0.95
        if what in SPOILT:
            break
        i = np.searchsorted(time, last - 0.1 - 0.5 * (last > 9.0))
        assert told[i, REASON] == Reason.VALID
        assert told[i, FRONT] == pytest.approx(true, rel=0.05)
        torque = CAR.front.torque_gain * true * x[i, P_MC]
        assert told[i, TORQUE_F] == pytest.approx(torque, rel=0.06)


def test_the_pads_stay_while_a_sensor_fails(drive_on, both):
    told = both(put(*BITE, A_X, np.nan)(samples_of(drive_on), drive_on.time)[0])
    before, last = np.searchsorted(drive_on.time, BITE) - 1
    assert told[last, FRONT] == pytest.approx(told[before, FRONT], rel=0.02)


def test_a_reset_while_braking_has_wider_bounds(drive_on, both):
    whole, late = both(samples_of(drive_on)), drive_on.time > 4.0
    reset = both(samples_of(drive_on)[late])
    at = np.searchsorted(drive_on.time, 4.9)
    known, now = whole[at], reset[at - np.flatnonzero(late)[0]]
    assert now[RATIO + 2] / now[RATIO + 1] > known[RATIO + 2] / known[RATIO + 1]


def test_standstill_and_reverse_have_their_reasons(both):
    rests = np.zeros((400, len(CHANNELS)))
    rests[100:, P_MC] = 10e5
    rests[250:, OMEGA] = -5.0
    assert set(both(rests)[120:, REASON]) == {Reason.SLOW}


def test_from_gas_to_brake_the_zeros_are_those_of_the_last_coasting(both):
    """A coast, 0.04 g of thrust on the front axle until the brake is applied, and a stop."""

    def motor(t):
        return 0.04 * CAR.weight * CAR.front.rolling_radius * (1.5 < t < 4.0), 0.0

    def pressure(t):
        return 20e5 * min(max((t - 4.05) / 0.2, 0.0), 1.0)

    run = drive(replace(REAL, motor=motor), pressure, 28.0, duration=6.5)
    log = noisy(as_log(run, "from gas"), 4)
    samples = samples_of(without(log, "T_drive_f", "T_drive_r"))
    unknown = both(samples)[-1]
    samples[(log.time > 1.4) & (log.time < 4.0), DRIVEN] = 1.0
    for known in (both(samples)[-1], both(samples_of(log))[-1]):  # the pedal, the torque
        for place in (FRONT, REAR):
            assert known[place + 1] < 0.38 < known[place + 2]
        assert known[LEVEL] == pytest.approx(1.0, abs=0.02)
    assert unknown[LEVEL] > 1.04  # the thrust is taken for a zero of a_x


def test_another_table_is_taken_at_rest_only(fitted, native):
    online, code = Online(fitted, STEP), native.library
    state, out = create_string_buffer(4096), create_string_buffer(1024)
    car = c_void_p(addressof(c_char.in_dll(code, "bte_this_car")))
    code.bte_init(state, car)
    for speed, taken in ((60.0, False), (0.0, True)):
        x = np.zeros(len(CHANNELS))
        x[OMEGA] = speed
        for _ in range(2):  # the first one is a jump
            online.step(x)
            code.bte_step(state, (c_double * len(x))(*x), out)
        assert online.exchange(fitted) == code.bte_exchange(state, car) == taken
        assert online.begun != taken


def test_a_car_with_an_effect_that_the_code_does_not_take_out_is_refused(fitted):
    late = Effects({"hydraulic_delay": {"delay": 0.1}})
    with pytest.raises(StoreError):
        require_plain(replace(fitted, vehicle=replace(CAR, effects=late)))
