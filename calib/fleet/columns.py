"""The columns of `results.parquet`: what each command says of a log."""

from dataclasses import dataclass

from calib.validation.metrics import METRICS

COMMANDS = ("fit", "validate", "check", "diagnose")


@dataclass(frozen=True)
class ResultColumn:
    """One column: its name, ``kind`` ("float", "bool" or "text"), unit and meaning."""

    name: str
    kind: str
    unit: str
    meaning: str


HEAD = (
    ResultColumn("log", "text", "1", "path as given"),
    ResultColumn("digest", "text", "1", "SHA-256 of the log; null if it cannot be read"),
    ResultColumn("status", "text", "1", "passed, failed, done or error"),
    ResultColumn("error", "text", "1", "what was wrong; null if nothing was"),
)
"""The first columns, of every command."""


def _float(name: str, unit: str, meaning: str) -> ResultColumn:
    return ResultColumn(name, "float", unit, meaning)


FIT = (
    _float("pad_friction_f", "1", "pad friction, front"),
    _float("pad_friction_r", "1", "pad friction, rear"),
    _float("pad_scale", "1", "common factor on the nominal pad friction"),
    _float("pad_friction_f_sigma", "1", "one sigma of it"),
    _float("pad_friction_r_sigma", "1", "one sigma of it"),
    _float("pad_scale_sigma", "1", "one sigma of it"),
    _float("deceleration_max", "1", "deceleration that the ramp reached, z"),
    _float("front_biased_up_to", "1", "z up to which the front axle brakes harder for its load"),
    _float("eta_peak", "1", "largest eta on the ramp"),
    _float("eta_peak_deceleration", "1", "z at which it was"),
    _float("eta_peak_is_real", "1", "1 if eta falls again within the ramp, else 0"),
    _float("residual_eta_rms_sigma", "1", "rms of what the fit leaves of eta, over its sigma"),
    _float("residual_slip_rms_sigma", "1", "the same of the slip; 0 without v"),
    _float("outliers", "1", "blocks of eta past four sigma"),
    _float("pad_ratio_nominal_weight", "1", "weight that the pads have the vehicle file's ratio"),
    ResultColumn("table_digest", "text", "1", "digest of the table"),
)

VALIDATE = (
    *(_float(name, "1", meaning) for name, meaning in METRICS.items()),
    ResultColumn("not_held", "text", "1", "figures that break a limit; null if none does"),
)

CHECK = (
    ResultColumn("usable_fit", "bool", "1", "usable for fit"),
    ResultColumn("usable_validate", "bool", "1", "usable for validate"),
    ResultColumn("usable_diagnose", "bool", "1", "usable for diagnose"),
    _float("samples", "1", "samples"),
    _float("duration", "s", "duration"),
    _float("rate", "Hz", "rate of the median step"),
    _float("jitter", "s", "rms departure of the steps from the median"),
    _float("gaps", "1", "holes in the clock"),
    _float("brakings", "1", "applications of the brake"),
    _float("lead_in", "s", "steady rolling before the first braking"),
    _float("coasting", "s", "all steady rolling without braking"),
    _float("speed_max", "m/s", "highest speed"),
    _float("deceleration_max", "1", "highest deceleration, z"),
    _float("pressure_max", "Pa", "highest p_mc"),
    _float("eta_zero", "1", "eta - 1 without braking"),
    _float("warnings", "1", "number of warnings"),
)

DIAGNOSE = (
    ResultColumn("verdict", "text", "1", "no_gap, named, ambiguous or unknown"),
    ResultColumn("effects", "text", "1", "named effects, joined by +"),
    _float("gap_before", "1", "gap on the hold-outs, no effect added"),
    _float("gap_after", "1", "gap on the hold-outs, with the named effects"),
    _float("gap_closed", "1", "share of the gap that is closed"),
)

COLUMNS: dict[str, tuple[ResultColumn, ...]] = {
    "fit": FIT,
    "validate": VALIDATE,
    "check": CHECK,
    "diagnose": DIAGNOSE,
}
"""The columns after `HEAD`, by command."""
