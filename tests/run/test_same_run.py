"""A copy of a run is known whatever was done to it, also by its fingerprint; two runs are two."""

from dataclasses import replace

import numpy as np
import pytest

from calib.run.same_run import fingerprint_of, same_as, same_run
from tests.support.hidden.cases import draw
from tests.support.made_runs import changed, made_run, ramp, stop

RUN = made_run(stop(level=20.0))
FINGERPRINT = fingerprint_of(RUN)
STEPS = {"p_mc": 2e4, "a_x": 0.1}  # resolution of the rounded copy; 0.05 for all others


def run_of(channels):
    return replace(RUN, channels=channels, digest="")


def with_noise(seed):
    """The same motion to the last digit, measured once more."""
    rng, clean = np.random.default_rng(seed), made_run(stop(level=20.0), noise=0.0)
    sigma = {"time": 0.0, "p_mc": 1e4, "a_x": 0.05}
    noise = {n: sigma.get(n, 0.02) * rng.normal(size=clean.time.size) for n in clean.channels}
    return run_of({n: x + noise[n] for n, x in clean.channels.items()})


def resampled(time, origin=0.0):
    """The run interpolated to other times; its clock begins at ``origin`` [s]."""
    channels = {name: np.interp(time, RUN.time, x) for name, x in RUN.channels.items()}
    return run_of(channels | {"time": time - time[0] + origin})


def rounded():
    steps = {n: STEPS.get(n, 0.05) for n in RUN.channels if n != "time"}
    coarse = {n: np.round(RUN[n] / step) * step for n, step in steps.items()}
    return run_of(RUN.channels | coarse)


COPIES = {
    "another digest": lambda: run_of(RUN.channels),
    "rounded": rounded,
    "cut": lambda: run_of({n: x[200:-200] for n, x in RUN.channels.items()}),
    "cut, with a clock of its own": lambda: resampled(RUN.time[200:]),
    "every second sample": lambda: run_of({n: x[::2] for n, x in RUN.channels.items()}),
    "means of two": lambda: run_of(
        {n: x.reshape(-1, 2).mean(axis=1) for n, x in RUN.channels.items()}
    ),
    "another rate": lambda: resampled(np.arange(0.0, 7.9, 1.0 / 70.0)),
    "another rate and clock": lambda: resampled(np.arange(1.0032, 7.9, 1.0 / 70.0), 5.0),
    "finer": lambda: resampled(np.arange(0.0, 7.9, 1e-3)),
}


@pytest.mark.parametrize("change", COPIES)
def test_a_copy_is_known(change):
    copy = COPIES[change]()
    assert same_run(RUN, copy)
    assert same_run(copy, RUN)
    assert same_as(FINGERPRINT, copy)


@pytest.mark.parametrize(
    "other",
    [
        with_noise(1),
        made_run(stop(level=20.4)),
        made_run(stop(level=20.0), speed=29.9),
        made_run(ramp()),
        made_run(lambda t: 0.0 * t),
    ],
    ids=["driven alike to the last digit", "pressure", "speed", "ramp", "coast"],
)
def test_two_runs_are_two(other):
    other = replace(other, digest="")
    assert not same_run(with_noise(2), other)
    assert not same_run(other, with_noise(2))
    assert not same_as(fingerprint_of(with_noise(2)), other)


def test_a_fingerprint_holds_the_means_to_a_quarter_of_their_noise():
    """Means of ten samples of white noise of 0.02 rad/s have a noise of 0.02/sqrt(10)."""
    x = RUN["omega_fl"]
    midpoints = 0.5 * (x[1:] + x[:-1])
    means = midpoints[: midpoints.size // 10 * 10].reshape(-1, 10).mean(axis=1)
    unit = next(c.unit for c in FINGERPRINT.channels if c.name == "omega_fl")
    assert np.max(np.abs(FINGERPRINT.view["omega_fl"] - means)) < 0.51 * unit
    assert 0.02 / np.sqrt(10.0) / 8.0 * 0.7 < unit < 0.02 / np.sqrt(10.0) / 4.0 * 1.3


def test_channels_without_noise_have_a_fingerprint():
    still = made_run(stop(level=20.0), noise=0.0)
    fingerprint = fingerprint_of(changed(still, v=None))
    assert fingerprint.view["p_mc"].size == fingerprint.view["a_x"].size
    assert "v" not in fingerprint.view


@pytest.mark.slow
def test_two_stops_at_one_pressure_from_unlike_speeds_are_two_runs():
    """40 Hz, a quarter of the noise: laid over each other, they agree in the wheels alone."""
    logs = {log.name: log for log in draw("varied", 96).calibration}
    assert not same_run(logs["hot:3"], logs["step_high:2"])
    assert not same_run(logs["step_high:2"], logs["hot:3"])
