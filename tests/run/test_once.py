"""Each view of a log is made once: calls are counted in a fit of two logs and in a validation."""

import cProfile
import pstats
from collections import Counter
from pathlib import Path

import pytest

from calib.estimation.validate import validate
from calib.fitting.fit import fit
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, noisy, ramp, stop

OF_A_LOG = (
    "remove_known_effects", "signals", "blocks", "sensor_noise", "driving_record", "slips_of",
    "speed_delay", "delays_of", "other_scale", "brake_response", "axles_of",
    "wheel_parts", "sensors_of",
)  # fmt: skip


def with_calls(work):
    """Return the result of ``work``, and how often it called each function behind a `Run`."""
    profile = cProfile.Profile()
    result = profile.runcall(work)
    counted = Counter()
    for (file, _, name), (_, number, *_) in pstats.Stats(profile).stats.items():
        if Path(file).parent.name == "run" and Path(file).name != "run.py":
            counted[name] += number
    return result, counted


@pytest.fixture(scope="module")
def fitted():
    coast = as_log(drive(REAL, lambda t: 0.0, 32.0, duration=6.0), "coast")
    logs = [noisy(ramp(REAL), 1), noisy(coast, 2)]
    return with_calls(lambda: fit(CAR, logs))


def test_a_fit_makes_each_view_of_a_log_once(fitted):
    _, counted = fitted
    assert {name: counted[name] for name in OF_A_LOG if counted[name] > 2} == {}
    assert counted["signals"] == counted["blocks"] == counted["driving_record"] == 2
    assert counted["speed_evidence"] <= 2 + counted["other_scale"]  # that of a smooth z, too
    assert counted["identify"] == 3  # before the logs, by all of them, by the coast alone


def test_a_validation_makes_each_view_of_a_log_once(fitted):
    """Beside it the ECU has signals of its own, which know nothing of what comes later."""
    table, _ = fitted
    log = noisy(stop(REAL), 3)
    _, counted = with_calls(lambda: validate(table, [log]))
    ecu = {"remove_known_effects": 2, "blocks": 2}
    assert {x: counted[x] for x in OF_A_LOG if counted[x] > ecu.get(x, 1)} == {}
    assert counted["causal_signals"] == 2
