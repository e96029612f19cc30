"""Hold a diagnosis against what was hidden.

    score(case, diagnosis, before, after)

``diagnosis`` is the content of diagnosis.json; ``before`` and ``after`` the replayed hold-outs by
log name and channel. Outcomes:

    exact      named, and the names are those hidden; for `none`, no gap; for `outside`, unknown
    set        what is hidden is among the names and those said to be indistinguishable from them;
               for `outside`, an honest set
    partial    of two hidden effects one is named and nothing else
    no_gap     a gap was hidden and not seen
    unknown    an effect of the catalogue was not recognised
    wrong      another name was given, and the hidden one is not even in the set
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from tests.support.hidden.cases import NOISE, HiddenCase
from tests.support.hidden.settings import Hidden

Replays = Mapping[str, Mapping[str, Array]]

BAR = 1e5
FAINT = frozenset({"mass_error", "wheel_inertia"})
"""Nearly a pad level: seen, in a set, or not seen are all right; another single name is not."""

CHANNELS = ("a_x", "omega_fl", "omega_fr", "omega_rl", "omega_rr", "v")


COUNTERPARTS: dict[str, dict[str, Callable[[Hidden], float]]] = {
    "aerodynamic_drag": {
        "drag_area": lambda h: h.drag_area,
        "load_share": lambda h: 0.0,  # its loads follow the tyre forces alone
    },
    "rolling_resistance": {"coefficient": lambda h: h.rolling},
    "road_grade": {"grade": lambda h: math.sin(math.atan(h.grade))},
    "engine_drag": {"drag_torque": lambda h: h.engine_torque},
    "pad_thermal_fade": {
        "fade_slope": lambda h: h.fade,
        "fade_onset": lambda h: h.fade_onset,
    },
    "pad_speed_dependence": {"speed_slope": lambda h: h.speed_slope},
    "pad_pressure_dependence": {"pressure_slope": lambda h: h.pressure_slope},
    "wet_pad_recovery": {
        "wet_loss": lambda h: h.wet_loss,
        "dry_energy": lambda h: h.dry_energy,
    },
    "rolling_radius_mismatch": {"radius_mismatch": lambda h: h.radius_mismatch},
    "brake_threshold_pressure": {"threshold": lambda h: h.threshold},
    "hydraulic_lag": {
        "time_constant": lambda h: h.lag + h.lag_behind,
        "lag_bend": lambda h: h.lag * h.lag_behind / (h.lag + h.lag_behind) ** 2,
    },
    "hydraulic_delay": {"delay": lambda h: h.delay},
    "rear_proportioning": {
        "knee_slope": lambda h: h.knee_slope,
        "knee": lambda h: h.knee,
    },
    "caliper_hysteresis": {
        # falling over rising: (1 + w/2)/(1 - w/2) here, 1/(1 - w) there
        # a fixed width is told at 20 bar
        "width": lambda h: (
            h.hysteresis / (1.0 + 0.5 * h.hysteresis) + 2.0 * h.hysteresis_fixed / 20e5
        ),
    },
    "pitch_coupling": {
        "natural_frequency": lambda h: 2.0 * math.pi * h.pitch_frequency,
        "damping": lambda h: h.pitch_damping,
        "pitch_gradient": lambda h: h.pitch_gain,
    },
    "accelerometer_bias": {"bias": lambda h: h.bias},
    "accelerometer_scale": {"scale_error": lambda h: h.scale_error},
    "wheel_inertia": {"extra_inertia": lambda h: h.inertia},
    "side_imbalance": {"imbalance": lambda h: h.imbalance},
    "disc_thickness_variation": {"amplitude": lambda h: h.thickness},
    "mass_error": {"mass_error": lambda h: h.mass_error},
    "residual_torque": {"residual_pressure": lambda h: h.sticking},
    "hydraulic_oscillation": {
        "response_time": lambda h: 1.0 / (2.0 * math.pi * h.surge),
        "line_damping": lambda h: h.surge_damping,
    },
    "rolling_radius_load": {"radius_load": lambda h: h.radius_load},
    "tone_ring_runout": {"runout": lambda h: h.tooth_error},
    "accelerometer_lag": {
        "filter_time": lambda h: math.sqrt(2.0) / (2 * math.pi * h.filter_frequency),
        "filter_bend": lambda h: 0.5,
    },
    "speed_delay": {"v_delay": lambda h: h.v_late},
    "wheel_speed_delay": {"omega_delay": lambda h: 0.5 * h.wheel_window},
    "regenerative_torque": {
        "regen_torque": lambda h: 2.0 * h.regen_torque,
        "regen_power": lambda h: 2.0 * h.regen_power,
        "regen_onset": lambda h: 1e5,
        "regen_lag": lambda h: h.regen_lag,
    },
}
"""True values of the parameters of the catalogue, SI, in the terms of the plant; where the plant
goes its own way, as in rolling, fade, wetness or hysteresis, none is exactly right."""

MOST_LEFT = 3.0
"""Noise units on the noise-free hold-outs above which an answer must say that something is left."""


@dataclass(frozen=True)
class Interval:
    """Whether one 95 % interval holds the truth."""

    effect: str
    parameter: str
    held: bool


@dataclass(frozen=True)
class Score:
    """One case against its answer.

    ``closed`` share of the gap to the noise-free hold-outs that is gone [1]; ``left`` rms distance
    to them, in noise units; ``remainder`` whether the answer says that something is left; ``axle``,
    ``driver`` whether an unknown was placed right, None if not asked or not said.
    """

    kind: str
    truth: tuple[str, ...]
    named: tuple[str, ...]
    verdict: str
    outcome: str
    closed: float
    left: float
    intervals: tuple[Interval, ...]
    axle: bool | None = None
    driver: bool | None = None
    remainder: bool = False

    @property
    def silent(self) -> bool:
        """Whether a verdict without a remainder stands while more than `MOST_LEFT` is left."""
        return self.verdict != "unknown" and not self.remainder and self.left > MOST_LEFT

    @property
    def passed(self) -> bool:
        """Whether the goal of its kind is met by this case."""
        if set(self.truth) & FAINT and len(self.truth) == 1:
            return self.outcome in ("exact", "set", "no_gap")
        if self.kind == "outside":
            return self.outcome in ("exact", "set")
        return self.outcome == "exact"


def score(
    case: HiddenCase,
    diagnosis: Mapping,
    before: Replays,
    after: Replays,
) -> Score:
    """Score one diagnosis."""
    axle, driver = placed(case, diagnosis) if case.kind == "outside" else (None, None)
    gap, left = (distance(case, replays) for replays in (before, after))
    return Score(
        kind=case.kind,
        truth=tuple(sorted(case.effects)),
        named=tuple(sorted(e["name"] for e in diagnosis["effects"])),
        verdict=diagnosis["verdict"],
        outcome=outcome(case, diagnosis),
        closed=1.0 - left / max(gap, 1e-15),
        left=left,
        intervals=intervals(case, diagnosis),
        axle=axle,
        driver=driver,
        remainder=bool(diagnosis.get("unexplained")),
    )


def outcome(case: HiddenCase, diagnosis: Mapping) -> str:
    """One of the words above."""
    verdict, truth = diagnosis["verdict"], set(case.effects)
    named = {e["name"] for e in diagnosis["effects"]}
    reported = named | {n for e in diagnosis["effects"] for n in e["indistinguishable_from"]}
    if case.kind == "outside":
        plain = {"unknown": "exact", "ambiguous": "set", "no_gap": "no_gap"}
        return plain.get(verdict, "wrong")
    if verdict in ("no_gap", "unknown"):
        return "exact" if verdict == "no_gap" and not truth else verdict
    if verdict == "named" and named == truth:
        return "exact"
    if truth and truth <= reported:
        return "set"
    if named < truth:
        return "partial"
    return "wrong"


def intervals(case: HiddenCase, diagnosis: Mapping) -> tuple[Interval, ...]:
    """Intervals of rightly named effects."""
    found = []
    for effect in diagnosis["effects"]:
        if effect["name"] in case.effects:
            for name, true in COUNTERPARTS[effect["name"]].items():
                if told := effect["parameters"].get(name):
                    low, high = (in_si(x, told["unit"]) for x in told["ci95"])
                    found.append(Interval(effect["name"], name, low <= true(case.hidden) <= high))
    return tuple(found)


FACTORS = {"bar": BAR, "%": 0.01, "kJ": 1e3, "%/bar": 0.01 / BAR, "1/bar": 1.0 / BAR, "ms": 1e-3}
FACTORS |= {"Hz": 2.0 * math.pi, "deg": math.pi / 180.0, "%/K": 0.01, "%*s/m": 0.01}


def in_si(value: float, unit: str) -> float:
    """A reported value in SI; units that are not above are SI already."""
    return value * FACTORS.get(unit, 1.0)


def distance(case: HiddenCase, replays: Replays) -> float:
    """Rms of replay less truth over channels and runs alike, in units of the noise of the case's
    own sensors [1]. A replay that ends early is compared as far as it goes."""
    variety = case.answer.get("variety") or {}
    factor, squares = variety.get("noise", 1.0), []
    for name, truth in case.truth.items():
        n = min(truth["time"].size, replays[name]["time"].size)
        for c in CHANNELS:
            off = (replays[name][c][:n] - truth[c][:n]) / (factor * NOISE[c].sd)
            squares.append(float(np.mean(off**2)))
    return math.sqrt(float(np.mean(squares)))


WHERE: dict[str, tuple[frozenset[str], frozenset[str]]] = {
    "abs_modulation": (frozenset({"front", "both"}), frozenset({"slip", "deceleration", "force"})),
    "stiffness_over_speed": (frozenset({"both", "front", "rear"}), frozenset({"speed"})),
    "tyre_warming": (
        frozenset({"both", "front", "rear"}),
        frozenset({"energy", "time", "elapsed", "temperature"}),
    ),
    "tank_slosh": (frozenset({"both", "body"}), frozenset({"time", "frequency", "deceleration"})),
    "weaker_applications": (
        frozenset({"both"}),
        frozenset({"time", "elapsed", "application", "energy"}),
    ),
    "seized_wheel": (frozenset({"rear"}), frozenset({"always", "time", "speed", "constant"})),
}
"""Right answers about an unknown: where, and on what it depends."""

AXLES = {"f": "front", "r": "rear", "vehicle": "body", "car": "body", "all": "both"}


def placed(case: HiddenCase, diagnosis: Mapping) -> tuple[bool | None, bool | None]:
    """Whether the axle and the driver of an unknown are right; None where nothing is said."""
    told = diagnosis.get("unexplained") or {}
    axles, drivers = WHERE[case.effects[0]]
    axle, driver = told.get("axle"), told.get("driver") or told.get("depends_on")
    if isinstance(driver, list | tuple):
        driver = driver[0] if driver else None
    return (
        None if axle is None else AXLES.get(axle, axle) in axles,
        None if driver is None else driver in drivers,
    )
