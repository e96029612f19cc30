"""Checks of `station`: the verdict on a car whose pads are known."""

from calib.errors import LogError
from calib.qualification.check import COUNT, Check
from calib.qualification.fitted import FRONT, REAR, STUDY
from calib.qualification.material import RAMPS, Material
from calib.station.identity import Identity
from calib.station.metrics import Car
from calib.station.station import StationOutcome, outcome, validated
from calib.store.state import REJECTED
from calib.validation.limits import FAILED, Limit

CAR, STOP = "simulation_study", "stop_noisy.parquet"
PADS = 0.4
RIGHT = (
    Limit("pad_friction_f", PADS * (1 - FRONT), PADS * (1 + FRONT), required=True),
    Limit("pad_friction_r", PADS * (1 - REAR), PADS * (1 + REAR), required=True),
    Limit("pad_scale", 1 - FRONT, 1 + FRONT, required=True),
)
"""What the pads of the car are, of the stop and of the car; its file says 0.4, too."""
WRONG = {
    "pad_friction_f": Limit("pad_friction_f", 1.1 * PADS, None),
    "pad_friction_r": Limit("pad_friction_r", None, 0.8 * PADS),
    "pad_scale": Limit("pad_scale", 1.1, None),
}
"""Limits that the car breaks, by the metric."""


def _judged(material: Material, limits: tuple[Limit, ...]) -> StationOutcome:
    table, stop = material.table(CAR), material.log(f"{CAR}/{STOP}")
    ramp = material.log(f"{CAR}/{RAMPS[CAR]}")
    results = [validated(table, stop, limits)]
    return outcome(Car(table, [ramp], [stop], results), [], limits, Identity("qualification"))


def _broken(found: StationOutcome) -> set[str]:
    return {check.figure for check in found.with_verdict(FAILED)}


def _verdicts(material: Material) -> float:
    """How many of four verdicts are right: what fails, and what becomes of the table."""
    good = _judged(material, RIGHT)
    right = [not _broken(good) and good.decision("").state != REJECTED]
    for name, limit in WRONG.items():
        bad = _judged(material, (*(one for one in RIGHT if one.figure != name), limit))
        right.append(_broken(bad) == {name} and bad.decision("").state == REJECTED)
    return float(sum(right))


def _ramp_as_stop(material: Material) -> float:
    """1 if the ramp of the fit is refused as a hold-out, else 0."""
    try:
        validated(material.table(CAR), material.log(f"{CAR}/{RAMPS[CAR]}"), RIGHT)
    except LogError:
        return 1.0
    return 0.0


CHECKS = (
    Check(
        "station_verdicts", "right of four verdicts on one car: no limit broken, and each of three",
        "verdicts", 4, COUNT, STUDY, _verdicts,
    ),
    Check(
        "station_holdout", "refused hold-outs on which the table was fitted", "logs", 1, COUNT,
        "a log of the fit proves nothing", _ramp_as_stop,
    ),
)  # fmt: skip
