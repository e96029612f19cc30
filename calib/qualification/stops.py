"""Checks of `validate`: pads and torques of hold-outs against their plants, and the verdict."""

from collections.abc import Callable

import numpy as np

from calib.qualification.check import COUNT, Check
from calib.qualification.fitted import BODY, FRONT, REAR, STUDY
from calib.qualification.material import RAMPS, Material
from calib.validation.limits import Limit
from calib.validation.validate import validate

TORQUES = "multi-body plant of sample_logs/third_party, channels true_Tb_*"
STOPS = {
    "mu30": ("hold1_const_mu30.parquet", 0.30, 0.30),
    "mu25_mu33": ("hold2_steps_muf25_mur33.parquet", 0.25, 0.33),
    "mu28": ("hold4_driver_mu28.parquet", 0.28, 0.28),
}
"""Hold-outs of the multi-body car, with the pad friction that the plant had in front and behind."""


def _pads(folder: str, stop: str, axle: str, told: str) -> Callable[[Material], float]:
    """Mean pad friction over the valid samples."""

    def measure(material: Material) -> float:
        estimate = material.stop(folder, stop, told).estimate
        found = estimate.front if axle == "f" else estimate.rear
        return float(np.mean(found.pad_friction[estimate.valid]))

    return measure


def _torque(stop: str) -> Callable[[Material], float]:
    """Rms error of the front brake torque over its rms, valid samples."""

    def measure(material: Material) -> float:
        estimate = material.stop("third_party", stop).estimate
        log, valid = material.log(f"third_party/{stop}"), estimate.valid
        true = 0.5 * (log.truth["true_Tb_fl"] + log.truth["true_Tb_fr"])[valid]
        error = estimate.front.torque[valid] - true
        return float(np.sqrt(np.mean(error**2) / np.mean(true**2)))

    return measure


def _outside(material: Material) -> float:
    """Share of valid samples of all three stops with the true front pads outside the interval."""
    outside: list[np.bool_] = []
    for stop, front, _ in STOPS.values():
        e = material.stop("third_party", stop).estimate
        outside += list(((e.front.lower > front) | (e.front.upper < front))[e.valid])
    return float(np.mean(outside))


def _failed(material: Material) -> float:
    """How many of two results that must fail do: a limit that is broken, a log that was fitted."""
    table, folder = material.table("third_party"), "third_party"
    stop = material.log(f"{folder}/{STOPS['mu30'][0]}")
    impossible = (Limit("pad_friction_f", 0.35, None),)
    broken = validate(table, [stop], None, impossible)
    fitted = validate(table, [material.log(f"{folder}/{RAMPS[folder]}")], None, ())
    return float(sum(not result.passed for result in (*broken, *fitted)))


def _of_stop(name: str) -> tuple[Check, Check]:
    stop, front, rear = STOPS[name]
    one, other = (_pads("third_party", stop, axle, "vehicle.toml") for axle in "fr")
    return (
        Check(f"stop_{name}_f", f"front pads of {stop}", "1", front, FRONT * front, BODY, one),
        Check(f"stop_{name}_r", f"rear pads of {stop}", "1", rear, REAR * rear, BODY, other),
    )


WRONG = "vehicle_wrong_pads.toml"
"""It says 0.5 and 0.6 where the plant has 0.4."""

CHECKS = (
    *(check for name in STOPS for check in _of_stop(name)),
    Check(
        "stop_wrong_file_f", "front pads of Section IV where the file says 0.5", "1", 0.4,
        0.4 * FRONT, STUDY, _pads("simulation_study", "stop_noisy.parquet", "f", WRONG),
    ),
    Check(
        "stop_wrong_file_r", "rear pads of Section IV where the file says 0.6", "1", 0.4,
        0.4 * REAR, STUDY, _pads("simulation_study", "stop_noisy.parquet", "r", WRONG),
    ),
    Check(
        "stop_torque", "rms error of the front brake torque of hold1, relative", "1", 0.0, FRONT,
        TORQUES, _torque(STOPS["mu30"][0]),
    ),
    Check(
        "stop_interval", "share of samples with the true front pads outside the 95 % interval",
        "1", 0.0, 0.05, BODY, _outside,
    ),
    Check(
        "verdict", "failed of two results that must fail", "results", 2, COUNT,
        "pads of 0.30 against a limit of 0.35 and more; a log that the table was fitted on",
        _failed,
    ),
)  # fmt: skip
