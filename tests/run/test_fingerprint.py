"""A fingerprint knows copies of its run and no other run, and comes back from JSON as it was."""

import json
from dataclasses import asdict, replace

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from calib.run.same_run import Fingerprint, fingerprint_of, same_as
from tests.run.test_same_run import COPIES, RUN, with_noise
from tests.support.made_runs import changed, made_run, ramp, stop

KEPT = fingerprint_of(RUN)


@pytest.mark.parametrize("done", COPIES)
def test_a_copy_is_known(done):
    assert same_as(KEPT, COPIES[done]())


@pytest.mark.parametrize(
    "other",
    [with_noise(1), made_run(stop(level=20.4)), made_run(stop(level=20.0), speed=29.9),
     made_run(ramp())],
    ids=["driven alike to the last digit", "pressure", "speed", "ramp"],
)  # fmt: skip
def test_another_run_is_none(other):
    assert not same_as(fingerprint_of(with_noise(2)), other)


def test_it_holds_the_means_to_a_quarter_of_their_noise():
    """Means of ten samples of white noise of 0.02 rad/s have a noise of 0.02/sqrt(10)."""
    x = RUN["omega_fl"]
    between = 0.5 * (x[1:] + x[:-1])
    means = between[: between.size // 10 * 10].reshape(-1, 10).mean(axis=1)
    unit = next(c.unit for c in KEPT.channels if c.name == "omega_fl")
    assert np.max(np.abs(KEPT.view["omega_fl"] - means)) < 0.51 * unit
    assert 0.02 / np.sqrt(10.0) / 8.0 * 0.7 < unit < 0.02 / np.sqrt(10.0) / 4.0 * 1.3


def test_it_is_small_and_comes_back_from_json():
    text = json.dumps(asdict(KEPT))
    assert len(text) < 600.0 * RUN.time[-1] + 1000.0
    assert TypeAdapter(Fingerprint).validate_json(text) == KEPT


def test_channels_without_noise_have_one_too():
    still = made_run(stop(level=20.0), noise=0.0)
    kept = fingerprint_of(changed(still, v=None))
    assert kept.view["p_mc"].size == kept.view["a_x"].size
    assert "v" not in kept.view


BROKEN = {
    "version": {"version": 2},
    "step": {"step": 0.0},
    "no wheels": {"channels": KEPT.channels[:3]},
    "foreign channel": {"channels": (*KEPT.channels, replace(KEPT.channels[0], name="x"))},
    "unit": {"channels": (replace(KEPT.channels[0], unit=-1.0), *KEPT.channels[1:])},
    "length": {"channels": (replace(KEPT.channels[0], differences="1 2"), *KEPT.channels[1:])},
    "no numbers": {"channels": (replace(KEPT.channels[0], differences="a"), *KEPT.channels[1:])},
    "too large": {"channels": (replace(KEPT.channels[0], differences="9" * 30),
                               *KEPT.channels[1:])},
}  # fmt: skip


@pytest.mark.parametrize("change", BROKEN)
def test_what_is_no_fingerprint_is_refused(change):
    data = json.dumps(asdict(KEPT) | {
        k: [asdict(c) for c in v] if k == "channels" else v for k, v in BROKEN[change].items()
    })  # fmt: skip
    with pytest.raises(ValidationError):
        TypeAdapter(Fingerprint).validate_json(data)
