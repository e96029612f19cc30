"""One shape for a warning: what speaks against a result although it is given."""

import math
from dataclasses import asdict, dataclass
from typing import Any

from calib.base.errors import not_finite

UNITS = {
    "a_x_scale": "1",
    "v_scale": "1",
    "a_x_offset": "m/s^2",
    "a_x_against_v": "g",
    "a_x_late": "s",
    "unexplained_drag": "m/s^2",
    "unexplained_braking_force": "1",
    "braking_force_missing": "1",
    "pressure_lag": "s",
    "force_step": "1",
    "pressure_zero": "bar",
    "impossible_samples": "1",
    "same_signal": "1",
    "v_held": "s",
    "v_late": "s",
    "wheels_held": "s",
    "v_of_wheels": "1",
    "lost_pulses": "1",
    "rolling_radius_f": "m",
    "rolling_radius_r": "m",
    "pads_off_file_f": "1",
    "pads_off_file_r": "1",
    "pad_ratio": "1",
    "rear_pressure_limited": "1",
    "pads_changed_apart": "1",
    "tyre_stiffness": "1",
    "level_changed": "1",
    "axles_exchanged": "1",
    "wheels_crossed": "1",
    "clock_rate": "Hz",
    "clock_jitter": "1",
    "clock_gaps": "s",
    "lead_in": "s",
    "lead_in_driven": "1",
    "standing": "s",
    "eta_zero": "1",
    "eta_zero_unknown": "1",
    "eta_zero_uncertain": "1",
    "sides_f": "1",
    "sides_r": "1",
    "axles_swapped": "1",
    "abs": "1",
    "locked_wheels": "1",
    "no_reference_speed": "1",
    "v_stuck": "s",
    "saturated": "s",
    "coarse_wheel_speeds": "1",
    "pressure_computed": "1",
    "pressure_per_g": "bar",
    "mass": "kg",
    "cg_height": "m",
    "track_width": "m",
    "piston_area_f": "cm^2",
    "piston_area_r": "cm^2",
    "effective_radius_f": "mm",
    "effective_radius_r": "mm",
    "friction_faces_f": "1",
    "friction_faces_r": "1",
    "pad_friction_f": "1",
    "pad_friction_r": "1",
    "wheelbase": "m",
    "static_load_f": "1",
    "cg_height_ratio": "1",
    "track_ratio": "1",
    "wheel_mass_f": "kg",
    "wheel_mass_r": "kg",
    "rotating_share": "1",
    "radius_ratio": "1",
    "disc_ratio_f": "1",
    "disc_ratio_r": "1",
    "brake_share_f": "1",
    "front_biased_up_to": "1",
    "lock_efficiency": "1",
}
"""The codes with the unit of what they measure, first those of a fit or an estimate, then those of
a log by itself, then those of a vehicle file, whose ``log`` is the name of the vehicle; 1 of a code
that measures nothing else says that it is so. A metric past its limit has its own name as code, and
is a number without unit."""


@dataclass(frozen=True)
class PlausibilityWarning:
    """One warning.

    ``code`` of `UNITS`, or the metric whose limit is not held; ``log`` its name, or that of the
    table; ``measured`` and ``expected`` (low, high; None where there is no bound) in the unit of
    the code; ``causes`` the most likely first; ``do`` what to do.

    Raises NotFiniteError for a number that is not finite: it would speak against something else.
    """

    code: str
    log: str
    measured: float
    expected: tuple[float | None, float | None]
    causes: tuple[str, ...]
    do: str

    def __post_init__(self) -> None:
        for number in (self.measured, *self.expected):
            if number is not None and not math.isfinite(number):
                raise not_finite(self.code, self.log)

    def __str__(self) -> str:
        return f"{self.log}: {self.text}"

    @property
    def text(self) -> str:
        """The warning as a sentence, without the log."""
        return (
            f"{self.code} is {self.amount}, expected {self.bounds}; "
            f"likely {', or '.join(self.causes)}; {self.do}"
        )

    @property
    def amount(self) -> str:
        """What was measured, with its unit."""
        unit = UNITS.get(self.code, "1")
        return f"{self.measured:.3g}" + ("" if unit == "1" else f" {unit}")

    @property
    def bounds(self) -> str:
        """The expected range in words."""
        low, high = self.expected
        if low is None:
            return f"at most {high:.3g}"
        if high is None or low == high:
            return f"{low:.3g}" if low == high else f"at least {low:.3g}"
        return f"{low:.3g} to {high:.3g}"


def to_dict(warning: PlausibilityWarning) -> dict[str, Any]:
    """A warning as JSON types; a bound that is not there is null."""
    return {**asdict(warning), "expected": [*warning.expected], "causes": [*warning.causes]}
