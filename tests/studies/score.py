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


@dataclass(frozen=True)
class Counterpart:
    """The true value of a catalogue parameter in SI, and the share by which forms may differ [1].

    ``slack`` is nought where plant and catalogue mean the same; where the plant goes its own way
    no parameter of the catalogue is exactly right.
    """

    value: Callable[[Hidden], float]
    slack: float = 0.0


COUNTERPARTS: dict[str, dict[str, Counterpart]] = {
    "aerodynamic_drag": {
        "drag_area": Counterpart(lambda h: h.drag_area),
        "load_share": Counterpart(lambda h: 0.0),  # its loads follow the tyre forces alone
    },
    "rolling_resistance": {"coefficient": Counterpart(lambda h: h.rolling, 0.08)},
    "road_grade": {"grade": Counterpart(lambda h: math.sin(math.atan(h.grade)))},
    "engine_drag": {"drag_torque": Counterpart(lambda h: h.engine_torque, 0.06)},
    "pad_thermal_fade": {
        "fade_slope": Counterpart(lambda h: h.fade, 0.05),
        "fade_onset": Counterpart(lambda h: h.fade_onset, 0.05),
    },
    "pad_speed_dependence": {"speed_slope": Counterpart(lambda h: h.speed_slope, 0.06)},
    "pad_pressure_dependence": {"pressure_slope": Counterpart(lambda h: h.pressure_slope)},
    "wet_pad_recovery": {
        "wet_loss": Counterpart(lambda h: h.wet_loss, 0.10),
        "dry_energy": Counterpart(lambda h: h.dry_energy, 0.30),
    },
    "rolling_radius_mismatch": {"radius_mismatch": Counterpart(lambda h: h.radius_mismatch)},
    "brake_threshold_pressure": {"threshold": Counterpart(lambda h: h.threshold, 0.03)},
    "hydraulic_lag": {
        "time_constant": Counterpart(lambda h: h.lag + h.lag_behind),
        "lag_bend": Counterpart(lambda h: h.lag * h.lag_behind / (h.lag + h.lag_behind) ** 2),
    },
    "hydraulic_delay": {"delay": Counterpart(lambda h: h.delay)},
    "rear_proportioning": {
        "knee_slope": Counterpart(lambda h: h.knee_slope),
        "knee": Counterpart(lambda h: h.knee),
    },
    "caliper_hysteresis": {
        # falling over rising: (1 + w/2)/(1 - w/2) here, 1/(1 - w) there
        # a fixed width is told at 20 bar
        "width": Counterpart(
            lambda h: h.hysteresis / (1.0 + 0.5 * h.hysteresis) + 2.0 * h.hysteresis_fixed / 20e5,
            0.10,
        ),
    },
    "pitch_coupling": {
        "natural_frequency": Counterpart(lambda h: 2.0 * math.pi * h.pitch_frequency),
        "damping": Counterpart(lambda h: h.pitch_damping),
        "pitch_gradient": Counterpart(lambda h: h.pitch_gain),
    },
    "accelerometer_bias": {"bias": Counterpart(lambda h: h.bias)},
    "accelerometer_scale": {"scale_error": Counterpart(lambda h: h.scale_error)},
    "wheel_inertia": {"extra_inertia": Counterpart(lambda h: h.inertia)},
    "side_imbalance": {"imbalance": Counterpart(lambda h: h.imbalance)},
    "disc_thickness_variation": {"amplitude": Counterpart(lambda h: h.thickness)},
    "mass_error": {"mass_error": Counterpart(lambda h: h.mass_error)},
    "residual_torque": {"residual_pressure": Counterpart(lambda h: h.sticking)},
    "hydraulic_oscillation": {
        "response_time": Counterpart(lambda h: 1.0 / (2.0 * math.pi * h.surge)),
        "line_damping": Counterpart(lambda h: h.surge_damping),
    },
    "rolling_radius_load": {"radius_load": Counterpart(lambda h: h.radius_load, 0.1)},
    "tone_ring_runout": {"runout": Counterpart(lambda h: h.tooth_error)},
    "accelerometer_lag": {
        "filter_time": Counterpart(lambda h: math.sqrt(2.0) / (2 * math.pi * h.filter_frequency)),
        "filter_bend": Counterpart(lambda h: 0.5),
    },
    "speed_delay": {"v_delay": Counterpart(lambda h: h.v_late)},
    "wheel_speed_delay": {"omega_delay": Counterpart(lambda h: 0.5 * h.wheel_window)},
    "regenerative_torque": {
        "regen_torque": Counterpart(lambda h: 2.0 * h.regen_torque, 0.05),
        "regen_power": Counterpart(lambda h: 2.0 * h.regen_power, 0.05),
        "regen_onset": Counterpart(lambda h: 1e5, 0.1),
        "regen_lag": Counterpart(lambda h: h.regen_lag, 0.1),
    },
}


MOST_LEFT = 3.0
"""Noise units on the noise-free hold-outs above which an answer must say that something is left."""


@dataclass(frozen=True)
class Interval:
    """Whether one 95 % interval holds the truth: as it stands, and with the slack of the form."""

    effect: str
    parameter: str
    held: bool
    held_with_slack: bool

    @property
    def same_form(self) -> bool:
        """Whether plant and catalogue mean the same by the parameter, so that it has one value."""
        return not COUNTERPARTS[self.effect][self.parameter].slack


@dataclass(frozen=True)
class Score:
    """One case against its answer.

    ``closed`` share of the gap to the noise-free hold-outs that is gone [1], nan without replays,
    ``by_channel`` the same; ``left`` rms distance to the noise-free hold-outs, in noise units,
    ``remainder`` whether the answer says that something is left; ``axle``, ``driver`` whether an
    unknown was placed right, None if not asked or not said.
    """

    kind: str
    truth: tuple[str, ...]
    named: tuple[str, ...]
    verdict: str
    outcome: str
    closed: float
    by_channel: dict[str, float]
    intervals: tuple[Interval, ...]
    axle: bool | None = None
    driver: bool | None = None
    left: float = math.nan
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
    before: Replays | None = None,
    after: Replays | None = None,
) -> Score:
    """Score one diagnosis."""
    axle, driver = placed(case, diagnosis) if case.kind == "outside" else (None, None)
    closed, by_channel, left = math.nan, {}, math.nan
    if before is not None and after is not None:
        closed, by_channel = gap_closed(case, before, after)
        left = math.sqrt(sum(distances(case, after).values()) / len(CHANNELS))
    return Score(
        kind=case.kind,
        truth=tuple(sorted(case.effects)),
        named=tuple(sorted(e["name"] for e in diagnosis["effects"])),
        verdict=diagnosis["verdict"],
        outcome=outcome(case, diagnosis),
        closed=closed,
        by_channel=by_channel,
        intervals=intervals(case, diagnosis),
        axle=axle,
        driver=driver,
        left=left,
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
        if effect["name"] not in case.effects:
            continue
        for name, part in COUNTERPARTS[effect["name"]].items():
            if name not in effect["parameters"]:
                continue
            told = effect["parameters"][name]
            low, high = (in_si(x, told["unit"]) for x in told["ci95"])
            true = part.value(case.hidden)
            more = part.slack * abs(true)
            held = low <= true <= high
            found.append(
                Interval(effect["name"], name, held, low - more <= true <= high + more),
            )
    return tuple(found)


FACTORS = {"bar": BAR, "%": 0.01, "kJ": 1e3, "%/bar": 0.01 / BAR, "1/bar": 1.0 / BAR, "ms": 1e-3}
FACTORS |= {"Hz": 2.0 * math.pi, "deg": math.pi / 180.0, "%/K": 0.01, "%*s/m": 0.01}


def in_si(value: float, unit: str) -> float:
    """A reported value in SI; units that are not above are SI already."""
    return value * FACTORS.get(unit, 1.0)


def gap_closed(case: HiddenCase, before: Replays, after: Replays) -> tuple[float, dict[str, float]]:
    """Share of the rms distance to the noise-free hold-outs that is gone, over all and by channel.

    Channels count in units of their noise. A replay that ends early is compared as far as it goes.
    """
    first, last = distances(case, before), distances(case, after)
    by_channel = {c: 1.0 - math.sqrt(last[c] / first[c]) if first[c] else 0.0 for c in CHANNELS}
    total = math.sqrt(sum(last.values()) / max(sum(first.values()), 1e-30))
    return 1.0 - total, by_channel


def distances(case: HiddenCase, replays: Replays) -> dict[str, float]:
    """Mean square of replay less truth by channel, in units of the noise, the runs alike [1].

    The noise is that of the case's own sensors.
    """
    squares = dict.fromkeys(CHANNELS, 0.0)
    variety = case.answer.get("variety") or {}
    factor = variety.get("noise", 1.0)
    for name, truth in case.truth.items():
        n = min(truth["time"].size, replays[name]["time"].size)
        for c in CHANNELS:
            off = (replays[name][c][:n] - truth[c][:n]) / (factor * NOISE[c].sd)
            squares[c] += float(np.mean(off**2)) / len(case.truth)
    return squares


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
