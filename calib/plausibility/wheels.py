"""Figures of the wheels: against a_x, v and each other, without a vehicle and with one.

The column `figure` of `rules.csv` names the public function here that measures a rule.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import permutations

import numpy as np

from calib.base.arrays import Mask
from calib.base.names import AXLE_NAMES, WHEEL_SPEEDS, G
from calib.base.warning import LIMITS, Measured, bounds_of, relative
from calib.car.balance import front_biased_up_to
from calib.car.beliefs import CAR, LOG
from calib.car.braking import BITE, MOVING
from calib.car.plausible import LEAST_FRONT_BIASED
from calib.plausibility.evidence import Evidence
from calib.plausibility.speed_mistakes import CLOCK, SpeedMistake, speed_mistakes
from calib.run.blocks import Blocks
from calib.run.driving_record import GREATEST_Z, NOMINAL_RADIUS, SETTLE
from calib.run.exchanged_wheels import crossed_side
from calib.run.filters import centred_mean, samples_in
from calib.run.resistance import identify

_UNITS = {"m/s": 1.0, "km/h": 1.0 / 3.6, "mph": 0.44704}  # units that are confused [m/s]
_UNIT_KNOWN = 0.16
"""Largest difference (logarithm) from the ratio of two units at which these are reported: half of
that between the closest ratios, 1.61 and 2.24."""
_STIFFEST = 60.0  # slip stiffness K above that of any tyre [1]
_ROLLED = 0.5  # shortest rolling that gives zero and slope of a_x [s]
_OTHER_SLOPE, _RADIUS = 0.003, 0.01  # sigma of a later change of slope, and of a file's radii [1]
_SLOWED = 0.25  # a_x is compared where the wheels' deceleration varies by more than this [1]
_CONFIRMED = 0.4  # errors of the scale of v by a_x and by radii agree if their ratio is 0.4 to 2.5
_BRAKED, _BRAKED_TIME = 0.05, 1.0  # least deceleration that shows slip [1], and its time [s]
_SOURCES = {"front": (1.0, 0.0), "rear": (0.0, 1.0), "four": (0.5, 0.5)}
"""Weights of the front and rear wheels from which v may be computed."""


def wheel_sign(evidence: Evidence) -> Iterator[Measured]:
    """Wheel speeds that are negative wherever the wheel turns."""
    backwards = []
    for channel in WHEEL_SPEEDS:
        omega = evidence.run.log[channel]
        turning = omega[np.abs(omega) > MOVING / NOMINAL_RADIUS]
        if turning.size and float(np.median(turning)) < 0.0:
            backwards.append(channel)
    yield Measured("wheel_sign", float(bool(backwards)), words={"wheels": ", ".join(backwards)})


def wheels(evidence: Evidence) -> Iterator[Measured]:
    """Sign and unit of a_x and v by the wheels; exchanged columns."""
    run, axles = evidence.run, evidence.run.axles
    if axles is None:
        return
    if axles.slope is not None:
        yield Measured("a_x_sign", float(axles.slope < 0.0))
        yield Measured("a_x_unit", abs(axles.slope))
    if axles.radius is not None:
        mistakes = speed_mistakes(run)
        yield from (_speed_mistake(axle, likely) for axle, likely in mistakes.items())
        if not mistakes:
            yield from _unit_of_v(axles.radius, radius_by_a_x=axles.slope or 0.0)
    crossed = crossed_side(run.wheels, run.alone)
    if crossed is not None:
        yield Measured("wheels_crossed_side", crossed.part, words={"found": crossed})
    eta = axles.eta_braked
    if eta is not None:
        rise = -eta.value if run.alone == "r" else eta.value
        yield Measured("axles_swapped", rise, eta.half, words=_axle_words(run.alone))


def _speed_mistake(axle: str, mistakes: Sequence[SpeedMistake]) -> Measured:
    """The first of the ``mistakes`` of v and the wheels of an ``axle``, or "" for both axles."""
    likeliest, *others = mistakes
    size = likeliest.size
    words = {"or": " or ".join(map(_in_words, others)), "percent": f"{100.0 * size:+.1f}"}
    if likeliest.kind == CLOCK:
        return Measured("v_clock", size, likeliest.sigma, words=words)
    offset_of_v = f"an offset of v of {-3.6 * size * likeliest.radius:+.1f} km/h"
    words["wheels"] = f"{AXLE_NAMES[axle]} wheel speeds" if axle else "wheel speeds"
    words["of_v"] = "" if axle else offset_of_v
    return Measured("wheel_offset", size, likeliest.sigma, words=words)


def _in_words(mistake: SpeedMistake) -> str:
    if mistake.kind == CLOCK:
        return f"a clock of v that runs {100.0 * mistake.size:+.1f} % off"
    return "an offset of the wheel speeds"


def _unit_of_v(radius: float, radius_by_a_x: float) -> Iterator[Measured]:
    """Rolling radius by v [m], and its ratio to the radius by a_x [m] if that is plausible."""
    low, high = bounds_of("v_unit")
    is_plausible = low <= radius_by_a_x <= high
    factor = radius / (radius_by_a_x if is_plausible else NOMINAL_RADIUS)
    words = {"unit": _confused_units(factor)}
    yield Measured("v_unit", radius, words=words)
    if is_plausible:
        yield Measured("v_unit_by_a_x", factor, words=words)


def _confused_units(factor: float) -> str:
    """Text of the units that make a v that is ``factor`` times too large."""
    for unit, read_as in permutations(_UNITS, 2):
        if factor > 0.0 and abs(math.log(factor * _UNITS[unit] / _UNITS[read_as])) < _UNIT_KNOWN:
            return f"v is in {unit} and was read as {read_as}"
    return "the unit of v or of the wheel speeds"


def _axle_words(alone: str | None) -> dict[str, str]:
    """Names of the axle that should slip more, the front one or that which brakes ``alone``."""
    more, less = ("rear", "front") if alone == "r" else ("front", "rear")
    return {"more": more, "less": less, "axle": less[0]}


def a_x_follows(evidence: Evidence) -> Iterator[Measured]:
    """Magnitude of the correlation of a_x and wheel deceleration before a wheel slips [1]."""
    driving = evidence.run.driving
    use = driving.moving & (driving.time < evidence.run.first_slip)
    for start, length in evidence.run.clock.gaps:  # no mean may cross a gap
        middle, reach = start + 0.5 * length, 0.5 * length + LIMITS.slope_time
        use &= np.abs(driving.time - middle) > reach
    width = samples_in(LIMITS.slope_time, driving.step) | 1
    z, wheel_z = (centred_mean(x, width)[use] for x in (driving.z, driving.wheel_z))
    if z.size > 1 and np.ptp(wheel_z) > _SLOWED and np.ptp(z) > 0.0:
        yield Measured("a_x_foreign", abs(float(np.corrcoef(z, wheel_z)[0, 1])))


def radii(evidence: Evidence) -> Iterator[Measured]:
    """Ratios of the rolling radii of axles, over that of the file if known, and of both sides."""
    axles, vehicle = evidence.run.axles, evidence.run.vehicle
    if axles is None:
        return
    if (eta := axles.front_rear) is not None:
        mismatch = eta.value if vehicle is None else vehicle.radius_mismatch(eta.value)
        yield Measured("eta_zero", mismatch, eta.half)
        yield Measured("eta_zero_uncertain", eta.half)
    for axle, sides in (("f", axles.left_right_f), ("r", axles.left_right_r)):
        if sides is not None:
            yield Measured(f"sides_{axle}", sides.value, sides.half)


def slip(evidence: Evidence) -> Iterator[Measured]:
    """Rise of eta under braking: the axle that brakes alone, else the front one, must slip more."""
    run, b = evidence.run, evidence.run.blocks
    front_biased = front_biased_up_to(run.car) if run.vehicle else LEAST_FRONT_BIASED
    highest_z = np.inf if run.alone else 0.8 * front_biased  # surely front-biased
    braked = np.flatnonzero(np.maximum(b.p_f, b.p_r) > BITE)
    start = float(b.end[braked[0]]) + SETTLE if braked.size else np.inf
    rise, error = eta_rise(b, (b.z > 0.1) & (b.z < highest_z) & (b.end > start))
    rise = -rise if run.alone == "r" else rise
    yield Measured("eta_falls", rise, error, words=_axle_words(run.alone))


def eta_rise(b: Blocks, use: Mask) -> tuple[float, float]:
    """Median of eta over ``use`` minus that of the lead-in, and its standard error, both [1].

    The median is robust against short locks. The result is NaN with fewer than four blocks of each,
    and if the torque of engine or motor, which changes eta, too, differs between them.
    """
    if min(np.count_nonzero(use), np.count_nonzero(b.lead_in)) < 4:
        return np.nan, np.nan
    for drive in (b.drive_f, b.drive_r):
        if abs(float(np.median(drive[use]) - np.median(drive[b.lead_in]))) > LIMITS.steady_drive:
            return np.nan, np.nan
    rolling, braked = b.eta[b.lead_in], b.eta[use]
    variance = sum(np.var(eta, ddof=1) / eta.size for eta in (rolling, braked))
    rise = float(np.median(braked)) - float(np.median(rolling))
    return rise, float(np.sqrt(0.5 * np.pi * variance))  # variance of a median is pi/2 of a mean's


def car_wheels(evidence: Evidence) -> Iterator[Measured]:
    """Rolling radii of the axles against those of the vehicle file."""
    run, rolling = evidence.run, evidence.run.rolling_radii
    if run.vehicle is None or rolling is None:
        return
    radii = [
        relative("rolling_radius_f", rolling[0], run.car.front.rolling_radius),
        relative("rolling_radius_r", rolling[1], run.car.rear.rolling_radius),
    ]
    difference = min((radius.value for radius in radii), key=abs)
    likely = "a log of another vehicle"
    if abs(difference) > bounds_of("a_x_scale")[1]:
        sensor = run.accelerometer(identify(run.car, ()))  # resistance by priors and file alone
        scale_of_v = -sensor.scale  # by a_x: a v that reads too high makes a_x look too small
        if math.sqrt(sensor.variance_scale) > 0.5 * abs(difference):  # too little braking
            likely = "the scale of v, or a log of another vehicle"
        elif _CONFIRMED < scale_of_v / difference < 1.0 / _CONFIRMED:
            likely = "the scale of v, by which a_x and v differ as much"
    yield from (replace(radius, words={"likely": likely}) for radius in radii)


def a_x_by_wheels(evidence: Evidence) -> Iterator[Measured]:
    """Error of the scale of a_x without v, less the usual error.

    It is the speed lost by the integral of a_x over the speed lost by the wheels, less 1. Zero of
    a_x and grade of the road are those of the lead-in, slip is that of usual tyres. The block with
    the least error counts: the slower the car, the less the slip matters.
    """
    run, b = evidence.run, evidence.run.blocks
    rolled = np.flatnonzero(b.lead_in)
    has_rolled = rolled.size * b.length >= _ROLLED
    if run.vehicle is None or b.v is not None or run.clock.gaps or not has_rolled:
        return
    slip, slip_sigma, *_ = CAR.compliance  # per z [1]
    rim = b.rim_speed(run.car)
    time = b.end - b.end[rolled[-1]]
    rolling_rate, rim_at_start = np.polyfit(time[rolled], rim[rolled], 1)
    rolling_z = -rolling_rate / G  # true deceleration on the lead-in
    z = np.where(time > 0.0, b.z - np.mean(b.z[rolled]) + rolling_z, 0.0)
    lost_by_a_x = b.speed_lost(z)
    lost = rim_at_start - rim / (1.0 - slip * np.clip(z, 0.0, 1.0))
    use = np.flatnonzero((time > 0.0) & (b.end < run.first_slip) & (rim > MOVING) & (lost > MOVING))
    if use.size:
        errors = np.hypot(rim * slip_sigma * z, _OTHER_SLOPE * G * time)[use] / lost[use]
        best, usual = use[np.argmin(errors)], LOG.a_x_scale
        scale = float(lost_by_a_x[best] / lost[best]) - 1.0 - usual.mean
        error = math.hypot(float(errors.min()), _RADIUS, usual.sigma)
        yield Measured("a_x_by_wheels", scale, error)


def slip_of_v(evidence: Evidence) -> Iterator[Measured]:
    """Rms slip of the braked wheels by v, over that of the stiffest tyre [1].

    If v is computed from wheels, their slip by v is zero, so the least slip of front, rear and four
    wheels counts. The force on a braked axle is about its load times the deceleration, or more.
    """
    rolling, b, shares = evidence.run.rolling_radii, evidence.run.blocks, []
    if rolling is None:
        return
    braking = (b.speed > MOVING) & (b.drive_f == 0.0) & (b.drive_r == 0.0)
    braking &= (b.z > _BRAKED) & (b.z < GREATEST_Z)
    rims = np.stack([rolling[0] * b.omega_f, rolling[1] * b.omega_r])  # (2, n), as the next two
    slips = 1.0 - rims / np.maximum(b.speed, MOVING)
    pressed = np.stack([b.p_f, b.p_r]) > BITE
    for source, weights in _SOURCES.items():
        use = braking & np.all(pressed[np.array(weights) > 0.0], axis=0)
        if np.count_nonzero(use) * b.length >= _BRAKED_TIME:
            rms = float(np.sqrt(np.mean((weights @ slips[:, use]) ** 2)))
            shares.append((_STIFFEST * rms / float(np.mean(b.z[use])), source))
    if shares:
        share, source = min(shares)
        yield Measured("v_of_wheels", share, words={"source": f"the {source} wheels"})


def v_scale(evidence: Evidence) -> Iterator[Measured]:
    """Scale of a_x against v by a wrong unit, clock or filter; 0 if a sensor errs more likely."""
    c = evidence.run.other_scale
    yield Measured("v_scale", c / (1.0 - c))  # a_x as read is the true one over 1 - c
