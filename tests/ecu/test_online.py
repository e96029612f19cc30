"""The estimator sample by sample, in Python and in C: what a whole log gives, and its life."""

from ctypes import addressof, c_char, c_double, c_void_p, create_string_buffer
from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import ProgramError, StoreError
from calib.car.effects.effects import Effects
from calib.ecu.native import Native, coded
from calib.ecu.translation import translated
from calib.estimation.known import require_plain
from calib.estimation.limits import DEFAULTS
from calib.estimation.online import (
    A_X,
    ANSWERS,
    CHANNELS,
    DRIVEN,
    FL,
    OMEGA,
    P_MC,
    STEERING,
    answered,
    samples_of,
)
from calib.estimation.reasons import Reason
from calib.estimation.sample_by_sample import online
from calib.estimation.validate import validate_one
from calib.run.blocks import BLOCK
from calib.table.exported import Precision
from tests.support.ecu_code import failing
from tests.support.plant import as_log, drive
from tests.support.programs import needs
from tests.support.reference_car import CAR, REAL, WET, noisy, stop, without

pytestmark = needs("cc")

STEP, READY = 0.005, 0
REASON, LEVEL, RATIO, FRONT, REAR, TORQUE_F, *_ = 0, *range(1, 28, 3)
FROZEN, IMPLAUSIBLE = {Reason.NO_PAD, Reason.IMPLAUSIBLE}, {Reason.IMPLAUSIBLE}
FAULT, LOCKED = {Reason.FAULT}, {Reason.LOCKED}
RELEASED = {Reason.VALID, Reason.NOT_BRAKED}


@pytest.fixture(scope="module")
def agreed(fitted):
    """Return a function that runs samples in Python and in C; both must give the same answers."""
    native = {step: Native(fitted, step, Precision()) for step in (STEP, BLOCK)}

    def run(samples, step=STEP):
        python, c = answered(fitted, step, samples), native[step].run(samples)
        assert np.array_equal(python[:, REASON], c[:, REASON])
        assert c == pytest.approx(python, rel=1e-9)
        assert np.isfinite(python).all()
        return python

    return run


@pytest.fixture(scope="module")
def wet():
    """A stop with a gap of 0.3 s."""
    log = noisy(stop(WET), 5)
    is_kept = np.abs(log.time - log.time[log.time.size // 2]) > 0.15
    channels = {name: x[is_kept] for name, x in log.channels.items()}
    truth = {name: x[is_kept] for name, x in log.truth.items()}
    return replace(log, channels=channels, truth=truth)


@pytest.fixture(scope="module")
def drive_on():
    """Samples of a coast, a stop to 12 m/s, a release, and a second stop with other pads."""
    car = replace(REAL, pads=lambda t: (0.38, 0.38) if t < 6.0 else (0.25, 0.25))
    how = {"duration": 10.0, "rate": 200.0, "stop_speed": 2.0}
    run = drive(car, lambda t: 20e5 * (3.0 < t < 5.0) + 14e5 * (t > 7.5), 32.0, **how)
    return samples_of(noisy(as_log(run), 3))


@pytest.mark.parametrize("seed", range(4))
def test_c_equals_python_while_sensors_fail_at_random(seed, drive_on, agreed):
    agreed(failing(drive_on, seed))
    agreed(failing(drive_on[::10], seed), BLOCK)  # where no block hides a sample


@pytest.mark.parametrize("seed", [None, 0, 1])
def test_sample_by_sample_the_answers_are_those_of_the_whole_log(seed, drive_on, fitted):
    estimator, samples = online(fitted, STEP), drive_on[:1500]
    samples = samples if seed is None else failing(samples, seed)
    answers = np.array(
        [[*estimator.step(dict(zip(CHANNELS, x, strict=True))).values()] for x in samples]
    )
    expected = answered(fitted, STEP, samples)
    assert np.array_equal(answers[:, REASON], expected[:, REASON])
    assert answers == pytest.approx(expected, rel=1e-9)


TIME = STEP * np.arange(2001)
ROWS = {
    "reset while braking": TIME > 4.0,
    "calls that come late or twice": np.delete(np.sort(np.r_[0:2001, 36:2001:37]), np.s_[29::30]),
    "a long coast": np.r_[np.tile(np.r_[0:580], 10), 0:2001],
}
"""By case: samples of `drive_on` in their order. The other cases have all samples once."""
FAILS = [
    (-1, 1, slice(6), np.nan), (1.999, 2.001, FL, 0), (3.4, 3.8, OMEGA, np.nan),
    (3.999, 4.001, A_X, -29.9), (4.1, 4.3, A_X, np.nan), (4.3, 4.5, A_X, 99.0),
    (4.699, 4.701, OMEGA, lambda x: 2 * x), (8.0, 8.3, P_MC, -2e6), (8.3, 8.6, P_MC, np.nan),
    (8.6, 8.8, FL, np.inf), (8.8, 9.0, FL, -np.inf),
]  # fmt: skip
"""Between two times [s], readings of channels that no car has, or that are no number."""
LIFE = {
    "two stops": ([], [(5.2, 7.4, {Reason.NOT_BRAKED})]),
    **{case: ([], []) for case in ROWS},
    "nothing at first": ([(-1, 1, OMEGA, 0)], [(0.999, 1.001, FAULT)]),
    "sensors fail": (FAILS, [(begin, end, FAULT) for begin, end, *_ in FAILS]),
    "a_x is frozen while the brake is released": (
        [(4.98, 5.5, A_X, lambda x: x[0])], [(4.9, 5.22, RELEASED)],
    ),
    "a_x is frozen once the pressure moves": (
        [(2.5, 99, A_X, lambda x: x[0])], [(3.4, 4.9, FROZEN), (0, 2.9, {Reason.NOT_BRAKED})],
    ),
    "a wheel locks, and for 1 s after": (
        [(3.6, 3.8, FL, lambda x: 0.5 * x)], [(3.9, 4.79, LOCKED), (4.9, 4.99, {Reason.VALID})],
    ),
    "all wheels lock at once": (
        [(4, 4.5, OMEGA, lambda x: x * np.linspace(1.0, -2.3, len(x)).clip(0.0)[:, None])],
        [(4.1, 5.0, LOCKED | FAULT)],
    ),
    "steered": ([(4, 5, STEERING, 0.2)], [(4.1, 5.0, {Reason.TURNED})]),
    "a motor's torque jumps while it rolls": (
        [(2.0, 2.7, DRIVEN + 1, -3e3)], [(4.0, 4.9, {Reason.VALID})],
    ),
    "a motor's torque jumps in a stop": (
        [(3.4, 3.6, DRIVEN + 1, 2e3)], [(3.5, 4.5, IMPLAUSIBLE), (4.7, 4.9, {Reason.VALID})],
    ),
    "ABS acts": ([(4, 4.4, DRIVEN + 3, 1)], [(4.1, 5.0, {Reason.ABS})]),
    "wheel speeds in km/h": (
        [(-1, 99, OMEGA, lambda x: x / 3.6)],
        [(3.4, 4.9, IMPLAUSIBLE | {Reason.BEYOND_MAP, Reason.NO_PAD, Reason.SLOW})],
    ),
    "it stands, and rolls back": (
        [(-1, 4.001, OMEGA, 0), (4, 99, OMEGA, -5), (2, 99, A_X, -1)], [(3.3, 5, {Reason.SLOW})],
    ),
}  # fmt: skip
"""By case: such readings, and the reasons expected between two times [s]."""
SPOILT = {*list(LIFE)[-9:]} - {x for x in LIFE if x.startswith("a motor")}
"""Cases whose pads are not known at the end of the first stop."""


@pytest.mark.parametrize("case", LIFE)
def test_whatever_happens_a_valid_answer_has_the_pads_in_its_bounds(case, drive_on, agreed):
    (readings, expected), rows, x = LIFE[case], ROWS.get(case, slice(None)), drive_on.copy()
    for begin, end, channels, value in readings:
        during = (begin < TIME) & (end > TIME)
        x[during, channels] = value(x[during, channels]) if callable(value) else value
    time, x, answers = TIME[rows], x[rows], agreed(x[rows])
    for begin, end, reasons in expected:
        within = answers[(time > begin) & (time < end)]
        assert within.size
        assert {*within[:, REASON]} <= reasons
        if reasons == FAULT:  # the pads stay
            assert within[:, FRONT] == pytest.approx(within[0, FRONT], rel=0.02)
    for first, last, true in ((3.0, 5.0, 0.38), (7.5, 10.0, 0.25)):
        valid = answers[(answers[:, REASON] == Reason.VALID) & (time > first) & (time < last)]
        for place in (FRONT, REAR):
            inside = (valid[:, place + 1] < true) & (valid[:, place + 2] > true)
            assert not inside.size or np.mean(inside) > 0.95
        if case in SPOILT:
            break
        i = np.argmax(time > last - 0.1 - 0.5 * (last > 9.0))
        assert answers[i, REASON] == Reason.VALID
        assert answers[i, FRONT] == pytest.approx(true, rel=0.05)
        torque = CAR.front.torque_gain * true * x[i, P_MC]
        assert answers[i, TORQUE_F] == pytest.approx(torque, rel=0.06)


@pytest.mark.parametrize("step", [-1.0, 0.5, 3.0])
def test_an_a_x_that_jumps_in_a_stop_is_not_believed(step, drive_on, agreed):
    x = drive_on.copy()
    x[(TIME > 4.0) & (TIME < 4.7), A_X] += step
    answers = agreed(x)
    assert {*answers[(TIME > 4.5) & (TIME < 4.7), REASON]} == IMPLAUSIBLE
    later = answers[(TIME > 7.9) & (TIME < 9.9)]
    assert {*later[:, REASON]} == {Reason.VALID}
    assert np.mean((later[:, FRONT + 1] < 0.25) & (later[:, FRONT + 2] > 0.25)) > 0.95


@pytest.mark.parametrize("step", [-1.0, -2.0])
def test_a_zero_of_a_x_that_moves_as_a_motor_lets_go_is_not_believed_in_the_next_stop(step, agreed):
    slows = 0.1 * CAR.weight * CAR.front.rolling_radius
    car = replace(REAL, motor=lambda t: (-slows * (2.8 < t < 4.0), 0.0))
    run = drive(car, lambda t: 20e5 * (3.0 < t < 5.0) + 14e5 * (t > 7.5), 36.0, duration=10.0)
    log = noisy(as_log(run), 3)
    x = samples_of(log)
    x[log.time > 4.0, A_X] += step
    answers = agreed(x)[log.time > 7.5]
    answers = answers[answers[:, REASON] == Reason.VALID]
    for place in (FRONT, REAR):
        assert np.all((answers[:, place + 1] < 0.38) & (answers[:, place + 2] > 0.38))


def test_a_reset_while_braking_has_wider_bounds(drive_on, agreed):
    usual, reset = (agreed(drive_on[(start < TIME) & (TIME < 4.9)])[-1] for start in (-1.0, 4.0))
    assert reset[RATIO + 2] / reset[RATIO + 1] > usual[RATIO + 2] / usual[RATIO + 1]


def test_from_gas_to_brake_the_zeros_are_those_of_the_last_coasting(agreed):
    """A coast, 0.04 g of thrust on the front axle until the brake is applied, and a stop."""
    thrust = 0.04 * CAR.weight * CAR.front.rolling_radius
    car = replace(REAL, motor=lambda t: (thrust * (1.5 < t < 4.0), 0.0))
    run = drive(car, lambda t: 20e5 * np.clip((t - 4.05) / 0.2, 0.0, 1.0), 28.0, duration=6.5)
    log = noisy(as_log(run), 4)
    samples = samples_of(without(log, "T_drive_f", "T_drive_r"))
    unknown = agreed(samples)[-1]
    samples[(log.time > 1.4) & (log.time < 4.0), DRIVEN] = 1.0
    for answer in (agreed(samples)[-1], agreed(samples_of(log))[-1]):  # the pedal, the torque
        for place in (FRONT, REAR):
            assert answer[place + 1] < 0.38 < answer[place + 2]
        assert answer[LEVEL] == pytest.approx(1.0, abs=0.02)
    assert unknown[LEVEL] > 1.04  # the thrust is taken for a zero of a_x


def test_other_data_are_taken_at_rest_and_what_is_of_the_sensors_lasts(fitted, drive_on):
    code = Native(fitted, STEP, Precision()).library
    state = create_string_buffer(4096)
    car = c_void_p(addressof(c_char.in_dll(code, "bte_car_here")))
    assert code.bte_init(state, car) == READY
    fresh = state.raw
    for row in drive_on[TIME < 4.9]:
        code.bte_step(state, (c_double * len(row))(*row))
    last = state.raw
    assert not code.bte_exchange(state, car)
    assert state.raw == last
    for _ in range(40):
        x = np.zeros(len(CHANNELS))
        code.bte_step(state, (c_double * len(x))(*x))
    assert code.bte_exchange(state, car)
    ours, theirs, zeros = (np.frombuffer(x, count=215) for x in (fresh, state.raw, last))
    (places,) = np.nonzero(ours != theirs)
    first = 14 + len(CHANNELS) + 3 * len(ANSWERS)  # of the filters: zeros of demand and of eta
    assert {*range(first, first + 4)} <= {*places.tolist()}
    assert places.size <= 7  # and of the lag, its variance, the seal
    assert theirs[first] == zeros[first]
    for damage in (None, 8 * first, 4):  # none, in a zero, in the layout
        bits = bytearray(state.raw)
        if damage is not None:
            bits[damage] ^= 1
        other = create_string_buffer(bytes(bits), len(bits))
        assert code.bte_resume(other, car) == (damage is None)


@pytest.mark.parametrize(
    "line", ["while x > 1.0: x -= 1.0", "x: float = 1.0", "import math", "x, y = 1.0, x"]
)
def test_what_has_no_counterpart_in_c_is_refused(line):
    with pytest.raises(ValueError, match="in C"):
        translated(f"def f(x: float) -> float:\n    'About.'\n    {line}\n    return x\n")


@pytest.mark.parametrize(("how", "tolerance"), [(Precision(), 1e-9), (Precision(8, 16), 0.05)])
def test_the_verdict_is_that_of_the_code(fitted, wet, how, tolerance):
    python = validate_one(fitted, wet, None, DEFAULTS)
    c = validate_one(fitted, wet, None, DEFAULTS, coded=coded(fitted, how))
    assert c.word == python.word
    for name in ("ecu_pad_friction_f", "ecu_pad_friction_r", "ecu_valid_share"):
        assert c.figures[name] == pytest.approx(python.figures[name], rel=tolerance)
    if how == Precision():
        answers, expected = c.estimate.ecu, python.estimate.ecu
        assert np.array_equal(answers.step.reason, expected.step.reason)
        assert np.array(answers.torque_r) == pytest.approx(np.array(expected.torque_r), rel=1e-9)


def test_what_cannot_be_coded_or_compiled_is_refused(fitted, monkeypatch):
    late = Effects({"hydraulic_delay": {"delay": 0.1}})
    with pytest.raises(StoreError):
        require_plain(replace(fitted, vehicle=replace(CAR, effects=late)))
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(ProgramError):
        coded(fitted, Precision())
