"""Checks of `diagnose`: the hidden cause of shipped cases is named, and none where none is."""

from collections.abc import Callable

from calib.qualification.check import COUNT, Check
from calib.qualification.material import Material

SIZE = 0.1
"""Relative tolerance of a parameter: by the page `diagnosis` of the manual 92 % of the intervals
hold the truth, and those of these two parameters are 4 % wide to each side."""


def _named(case: str, name: str) -> Callable[[Material], float]:
    """1 if the diagnosis names this effect and no other one, 0 if not."""

    def measure(material: Material) -> float:
        found = material.diagnosis(case)
        return float(found.verdict == "named" and [one.name for one in found.effects] == [name])

    return measure


def _size(case: str, name: str, parameter: str) -> Callable[[Material], float]:
    def measure(material: Material) -> float:
        effects = {one.name: one for one in material.diagnosis(case).effects}
        return effects[name].parameters[parameter].value

    return measure


def _no_gap(material: Material) -> float:
    return float(material.diagnosis("hidden/case_5").verdict == "no_gap")


DRAG, LAG = 0.7444375719787885, 0.19562694409268117


def _answer(case: int) -> str:
    return f"independent plant, sample_logs/hidden/case_{case}/answer.json"


CHECKS = (
    Check(
        "drag_named", "1 if aerodynamic drag, and it alone, is named", "1", 1, COUNT, _answer(0),
        _named("hidden/case_0", "aerodynamic_drag"),
    ),
    Check(
        "drag_size", "drag area that was hidden", "m^2", DRAG, SIZE * DRAG, _answer(0),
        _size("hidden/case_0", "aerodynamic_drag", "drag_area"),
    ),
    Check(
        "lag_named", "1 if the hydraulic lag, and it alone, is named", "1", 1, COUNT, _answer(2),
        _named("hidden/case_2", "hydraulic_lag"),
    ),
    Check(
        "lag_size", "time constant that was hidden", "s", LAG, SIZE * LAG, _answer(2),
        _size("hidden/case_2", "hydraulic_lag", "time_constant"),
    ),
    Check(
        "no_cause", "1 if nothing is named where nothing is hidden", "1", 1, COUNT, _answer(5),
        _no_gap,
    ),
)  # fmt: skip
