"""Checks of `fit`: pads and D of two ramps against what their plants were given."""

from collections.abc import Callable

import numpy as np

from calib.qualification.check import Check
from calib.qualification.material import RAMPS, Material

FRONT, REAR = 0.03, 0.08
"""Relative tolerances of pad friction: those of the torque in the default limits of `validate`."""
D_TOLERANCE = 0.02
"""Error of D from which a mistake counts in the study of mistakes, `tests/studies/mistakes.py`."""
AT, NEAR = 0.3, 0.02
"""Deceleration at which D is compared, and half the range of samples that are averaged [1]."""

STUDY = "plant of sample_logs/simulation_study, Section IV of the paper: pads of 0.4"
BODY = "multi-body plant of sample_logs/third_party, channels true_mu_pad_*"
FORCES = "multi-body plant of sample_logs/third_party, channels true_Fx_* and true_Fz_*"


def _pads(folder: str, axle: str) -> Callable[[Material], float]:
    def measure(material: Material) -> float:
        pads = material.table(folder).calibration
        return (pads.pad_friction_f if axle == "f" else pads.pad_friction_r).value

    return measure


def _pad_error(axle: str) -> Callable[[Material], float]:
    """Pad friction of the table over the mean true one of the braked ramp, less 1."""

    def measure(material: Material) -> float:
        log = material.log(f"third_party/{RAMPS['third_party']}")
        true = np.mean(log.truth[f"true_mu_pad_{axle}"][log["p_mc"] > 5e5])
        return _pads("third_party", axle)(material) / float(true) - 1.0

    return measure


def _split_error(material: Material) -> float:
    """D of the table at 0.3 g less the true one, from forces and loads of the plant."""
    log, table = material.log(f"third_party/{RAMPS['third_party']}"), material.table("third_party")
    near = np.abs(-log["a_x"] / 9.80665 - AT) < NEAR
    F = [
        (np.abs(log.truth[f"true_Fx_{side}l"] + log.truth[f"true_Fx_{side}r"]))
        / (log.truth[f"true_Fz_{side}l"] + log.truth[f"true_Fz_{side}r"])
        for side in "fr"
    ]
    curve = table.paper
    return float(np.interp(AT, curve.z, curve.f1 - curve.f2) - np.mean((F[0] - F[1])[near]))


CHECKS = (
    Check(
        "fit_pads_f", "front pad friction of the table of Section IV", "1", 0.4, 0.4 * FRONT,
        STUDY, _pads("simulation_study", "f"),
    ),
    Check(
        "fit_pads_r", "rear pad friction of the table of Section IV", "1", 0.4, 0.4 * REAR,
        STUDY, _pads("simulation_study", "r"),
    ),
    Check(
        "fit_body_pads_f", "relative error of the front pads of the multi-body car's table", "1",
        0.0, FRONT, BODY, _pad_error("f"),
    ),
    Check(
        "fit_body_pads_r", "relative error of the rear pads of the multi-body car's table", "1",
        0.0, REAR, BODY, _pad_error("r"),
    ),
    Check(
        "fit_split", "error of D = f1 - f2 at 0.3 g of the multi-body car's table", "1",
        0.0, D_TOLERANCE, FORCES, _split_error,
    ),
)  # fmt: skip
