"""Plain names of metrics for pages and pictures: what people call them, in the unit they read.

The keys are those of the JSON files and of limits files; a page shows them small beside the name.
"""

import math
from dataclasses import dataclass

NBSP = "\xa0"
"""Space at which no line ends."""


def counted(number: int, what: str) -> str:
    """A number of things.

    >>> counted(1, "log"), counted(2, "log")
    ('1 log', '2 logs')
    """
    return f"{number} {what}{'s' * (number != 1)}"


def plus_minus(value: float, half: float) -> str:
    r"""A value with the half width of its interval, with three decimals, on one line.

    >>> plus_minus(0.38, 0.0236)
    '0.380\xa0±\xa00.024'
    """
    return f"{value:.3f}{NBSP}\N{PLUS-MINUS SIGN}{NBSP}{half:.3f}"


def signed_percent(share: float) -> str:
    r"""A change in whole percent with its sign; no sign where it rounds to nothing.

    >>> signed_percent(0.014), signed_percent(-0.003)
    ('+1\xa0%', '0\xa0%')
    """
    whole = round(100.0 * share)
    return f"{whole:+d}{NBSP}%" if whole else f"0{NBSP}%"


@dataclass(frozen=True)
class Plain:
    """How a metric is shown: ``name``, ``unit`` ("" without one), ``factor`` from SI to it.

    ``step``: the smallest difference that matters, in the metric's SI unit; 0 if not known. The
    decimals of a shown value follow from it.
    """

    name: str
    unit: str = ""
    factor: float = 1.0
    step: float = 0.0

    @property
    def heading(self) -> str:
        """Name and unit: `Valid samples [%]`."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    def value(self, value: float | None, digits: int = 4) -> str:
        """A value in the unit shown, without the unit.

        >>> Plain("Valid samples", "%", 100.0, 0.002).value(0.9516)
        '95.2'
        """
        if value is None or not math.isfinite(value):
            return "not known"
        shown = self.factor * value
        if not self.step:
            return f"{shown:.{digits}g}"
        places = max(0, -math.floor(math.log10(self.factor * self.step) + 1e-9))
        text = f"{shown:.{places}f}"
        return text.removeprefix("-") if float(text) == 0.0 else text

    def with_unit(self, value: float | None) -> str:
        """A value with its unit, which stay on one line: `95.2 %`."""
        text = self.value(value)
        return f"{text}{NBSP}{self.unit}" if self.unit and text != "not known" else text

    def bounds(self, low: float | None, high: float | None) -> str:
        r"""A range in the unit shown, as it was written: `step` rounds no limit.

        >>> Plain("Valid samples", "%", 100.0, 0.01).bounds(0.125, None)
        'at least 12.5\xa0%'
        """
        unit = f"{NBSP}{self.unit}" if self.unit else ""
        ends = [None if x is None else f"{self.factor * x:.10g}" for x in (low, high)]
        if ends == [None, None]:
            return "none"
        if ends[0] is None or ends[1] is None:
            return (f"at most {ends[1]}" if ends[0] is None else f"at least {ends[0]}") + unit
        return f"{ends[0]} to {ends[1]}{unit}"


def _percent(name: str, step: float = 0.001) -> Plain:
    return Plain(name, "%", 100.0, step)


def _sigma(name: str) -> Plain:
    return Plain(name, "sigma", 1.0, 0.1)


METRICS: dict[str, Plain] = {
    # of a car
    "ramp_deceleration": Plain("Deceleration that the ramp reached", "g", 1.0, 0.01),
    "measured_share": _percent("Rows of the table that were measured"),
    "band_width": _percent("Half width of the table's 95 % band"),
    "ramp_eta_zero": _percent("Difference of the axles' tyre radii from the file's, ramp", 0.0001),
    "pad_scale": _percent("Pad friction as a share of the vehicle file's"),
    "pad_ratio": _percent("Front over rear pads, against the vehicle file"),
    "side_difference_f": _percent("Front brakes, left less right"),
    "side_difference_r": _percent("Rear brakes, left less right"),
    "repeatability_f": _percent("Front pads, stop farthest from their mean"),
    "repeatability_r": _percent("Rear pads, stop farthest from their mean"),
    "golden_distance": _percent("Distance of D from the golden table"),
    "golden_bands": Plain("The same over both 95 % bands", "", 1.0, 0.01),
    "golden_pads_f": _percent("Front pads against the golden table"),
    "golden_pads_r": _percent("Rear pads against the golden table"),
    "golden_stiffness": _percent("Tyre stiffness against the golden table"),
    "golden_sigma_d": _sigma("D against the golden fleet"),
    "golden_sigma_level": _sigma("Pad level against the golden fleet"),
    "golden_sigma_ratio": _sigma("Pad ratio against the golden fleet"),
    "golden_sigma_stiffness": _sigma("Tyre stiffness against the golden fleet"),
    # of a stop
    "valid_share": _percent("Valid samples"),
    "covered_share": _percent("Valid samples that the table covers"),
    "pad_friction_f": Plain("Pad friction, front", "", 1.0, 0.001),
    "pad_friction_r": Plain("Pad friction, rear", "", 1.0, 0.001),
    "pad_friction_drift_f": _percent("Change of the front pads within the stop"),
    "pad_friction_drift_r": _percent("Change of the rear pads within the stop"),
    "interval_f": _percent("Half width of the 95 % interval, front pads"),
    "interval_r": _percent("Half width of the 95 % interval, rear pads"),
    "innovation_rms": Plain("Errors of prediction over those expected", "", 1.0, 0.01),
    "innovation_lag1": Plain("Likeness of successive errors of prediction", "", 1.0, 0.01),
    "innovation_colour": Plain("Lasting part of the errors of prediction", "", 1.0, 0.01),
    "eta_zero": _percent("Difference of the axles' tyre radii from the file's", 0.0001),
    "force_sum_error": _percent("Error of the sum of forces"),
    "torque_error_f": _percent("Error of the front torque"),
    "torque_error_r": _percent("Error of the rear torque"),
    "pad_friction_bias_f": _percent("Mean error of the front pads"),
    "pad_friction_bias_r": _percent("Mean error of the rear pads"),
    "final_error_f": _percent("Error of the front pads at the end"),
    "final_error_r": _percent("Error of the rear pads at the end"),
    "normalised_force_rmse_f": Plain("Error of F_x/F_z, front", "", 1.0, 0.001),
    "normalised_force_rmse_r": Plain("Error of F_x/F_z, rear", "", 1.0, 0.001),
    "truth_in_interval": _percent("Samples with the truth in the 95 % interval"),
    "gain_over_nominal": Plain(
        "Torque error of nominal pads over that of the estimate", "", 1, 0.1
    ),
    # of a fit
    "pad_friction_f_sigma": Plain("Front pads, one sigma", "", 1.0, 0.001),
    "pad_friction_r_sigma": Plain("Rear pads, one sigma", "", 1.0, 0.001),
    "pad_scale_sigma": _percent("Pad friction over the file's, one sigma"),
    "deceleration_max": Plain("Highest deceleration", "g", 1.0, 0.01),
    "front_biased_up_to": Plain("Front axle locks first up to", "g", 1.0, 0.01),
    "eta_peak": Plain("Largest slip ratio of the axles, eta", "", 1.0, 0.0001),
    "eta_peak_deceleration": Plain("Deceleration at the largest eta", "g", 1.0, 0.01),
    "eta_peak_is_real": Plain("Eta falls again within the ramp", "1 = yes", 1.0, 1.0),
    "residual_eta_rms_sigma": Plain("Errors of eta in the fit over those expected", "", 1, 0.01),
    "residual_slip_rms_sigma": Plain("Errors of slip in the fit over those expected", "", 1, 0.01),
    "outliers": Plain("Blocks of eta left out", "blocks", 1.0, 1.0),
    "pad_ratio_nominal_weight": _percent("Weight of the vehicle file in the pad ratio"),
    # of a log
    "samples": Plain("Samples", "", 1.0, 1.0),
    "duration": Plain("Duration", "s", 1.0, 0.1),
    "rate": Plain("Rate", "Hz", 1.0, 0.1),
    "jitter": Plain("Jitter of the clock", "ms", 1e3, 1e-5),
    "gaps": Plain("Gaps in the clock", "gaps", 1.0, 1.0),
    "brakings": Plain("Applications of the brake", "", 1.0, 1.0),
    "lead_in": Plain("Steady rolling before the braking", "s", 1.0, 0.1),
    "coasting": Plain("Steady rolling in all", "s", 1.0, 0.1),
    "speed_max": Plain("Highest speed", "km/h", 3.6, 0.1 / 3.6),
    "pressure_max": Plain("Highest brake pressure", "bar", 1e-5, 1e4),
    "warnings": Plain("Warnings", "", 1.0, 1.0),
    # codes of warnings
    "level_changed": _percent("Brakes changed from the ramp to the stops"),
    "pads_changed_apart": _percent("Front and rear pads changed apart"),
    "axles_exchanged": Plain("Front and rear wheel speeds exchanged, log odds"),
    "pads_off_file_f": Plain("Front pads, not as in the vehicle file", "", 1.0, 0.001),
    "pads_off_file_r": Plain("Rear pads, not as in the vehicle file", "", 1.0, 0.001),
    "a_x_scale": _percent("Scale of a_x"),
    "v_scale": _percent("v against a_x"),
    "unexplained_braking_force": _percent("Braking force without pressure"),
    "braking_force_missing": _percent("Braking force that is missing"),
    "tyre_stiffness": _percent("Slip stiffness of the tyres"),
    "rear_pressure_limited": Plain("Limited rear pressure, fall of the chi-square"),
    "v_of_wheels": _percent("Slip against v, over the least of any tyre"),
    "lost_pulses": _percent("Wheel speed samples that lost a pulse"),
    "saturated": Plain("Time at the end of a channel's range", "s", 1.0, 0.1),
    "sides_f": _percent("Front brakes, left less right"),
    "sides_r": _percent("Rear brakes, left less right"),
    # of a diagnosis
    "gap_before": Plain("Gap on the hold-outs, nothing added", "times the noise", 1.0, 0.1),
    "gap_after": Plain("Gap on the hold-outs, effects added", "times the noise", 1.0, 0.1),
    "gap_closed": _percent("Share of the gap that is closed"),
}
"""Each metric by its key."""

WORDS = {
    "usable_fit": "Usable for fit",
    "usable_validate": "Usable for validate",
    "usable_diagnose": "Usable for diagnose",
    "not_held": "Limits that are not held",
    "warned": "Warnings",
    "table_digest": "Digest of the table",
    "verdict": "Verdict",
    "effects": "Named effects",
}
"""Columns of text and of yes and no by their keys."""


def plain(key: str, unit: str = "1") -> Plain:
    """How a metric is shown; one that is not known by its key with its ``unit``."""
    return METRICS.get(key) or Plain(WORDS.get(key, key), "" if unit == "1" else unit)
