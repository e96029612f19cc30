"""Figures of the wheels: against a_x, v and each other, without a vehicle and with one.

Each function is a figure of `rules.csv` by its name.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import permutations

import numpy as np

from calib.base.arrays import Mask
from calib.base.names import AXLE_NAMES, WHEELS, G
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

_SPEEDS = {"m/s": 1.0, "km/h": 1.0 / 3.6, "mph": 0.44704}  # units that are confused [m/s]
_UNIT_KNOWN = 0.16
"""Largest difference (logarithm) from the ratio of two units at which these are reported: half of
that between the closest ratios, 1.61 and 2.24."""
_STIFFEST = 60.0  # slip stiffness over load above that of any tyre [1]
_ROLLED, _OTHER_SLOPE, _RADIUS = 0.5, 0.003, 0.01
"""Least rolling [s] for zero and slope of a_x; sigma of a later change of the slope [1], and of the
radii of a vehicle file [1]."""
_SLOWS = 0.25  # change of the slowing of the wheels with which a_x is compared [g]
_MOST_OF_IT = 0.4  # share of the difference of v and wheels that a_x must confirm [1]
_BRAKED = 0.05  # deceleration [1] from which slip is seen
_MADE_OF = {"front": (1.0, 0.0), "rear": (0.0, 1.0), "four": (0.5, 0.5)}
"""Weights of the front and rear wheels that v may be made of."""
_TIME = 1.0  # time of such braking that is needed [s]


def wheel_sign(e: Evidence) -> Iterator[Measured]:
    """Wheel speeds that are negative wherever the wheel turns."""
    turning, log = MOVING / NOMINAL_RADIUS, e.run.log
    speeds = {wheel: log[f"omega_{wheel}"] for wheel in WHEELS}
    backwards = [
        f"omega_{wheel}"
        for wheel, omega in speeds.items()
        if np.any(fast := np.abs(omega) > turning) and float(np.median(omega[fast])) < 0.0
    ]
    yield Measured("wheel_sign", float(bool(backwards)), words={"wheels": ", ".join(backwards)})


def wheels(e: Evidence) -> Iterator[Measured]:
    """Sign and unit of a_x and v by the wheels; exchanged columns."""
    axles = e.run.axles
    if axles is None:
        return
    if (slope := axles.slope) is not None:
        yield Measured("a_x_sign", float(slope < 0.0))
        yield Measured("a_x_unit", abs(slope))
    mistakes = speed_mistakes(e.run) if axles.radius is not None else {}
    for axle, named in mistakes.items():
        yield _against_v(axle, named)
    if axles.radius is not None and not mistakes:
        yield from _of_v(axles.radius, slope or 0.0)
    if (crossed := crossed_side(e.run.wheels, e.run.alone)) is not None:
        yield Measured("wheels_crossed_side", crossed.part, words={"found": crossed})
    if (eta := axles.eta_braked) is not None:
        rise = -eta.value if e.run.alone == "r" else eta.value
        yield Measured("axles_swapped", rise, eta.half, words=_sides(e.run.alone))


def a_x_follows(e: Evidence) -> Iterator[Measured]:
    """Correlation of a_x with the slowing of the wheels before any slips deeply, its size [1]."""
    driving, slipping = e.run.driving, e.run.slipping
    use = driving.moving & (driving.time < (slipping.first if slipping else np.inf))
    width = samples_in(LIMITS.slope_time, driving.step) | 1
    z, wheel_z = (centred_mean(x, width)[use] for x in (driving.z, driving.wheel_z))
    if z.size > 1 and np.ptp(wheel_z) > _SLOWS and np.ptp(z) > 0.0:
        yield Measured("a_x_foreign", abs(float(np.corrcoef(z, wheel_z)[0, 1])))


def _against_v(axle: str, mistakes: Sequence[SpeedMistake]) -> Measured:
    """The likeliest of the ``mistakes`` of v and the wheels of an ``axle``, or "" for both."""
    first, *others = mistakes
    words = {"or": " or ".join(map(_in_words, others)), "percent": f"{100.0 * first.size:+.1f}"}
    if first.kind == CLOCK:
        return Measured("v_clock", first.size, first.sigma, words=words)
    words["wheels"] = f"{AXLE_NAMES[axle]} wheel speeds" if axle else "wheel speeds"
    of_v = f"an offset of v of {-3.6 * first.size * first.radius:+.1f} km/h"
    words["of_v"] = "" if axle else of_v
    return Measured("wheel_offset", first.size, first.sigma, words=words)


def _in_words(mistake: SpeedMistake) -> str:
    of_clock = f"a clock of v that runs {100.0 * mistake.size:+.1f} % off"
    return of_clock if mistake.kind == CLOCK else "an offset of the wheel speeds"


def _of_v(radius: float, by_a_x: float) -> Iterator[Measured]:
    low, high = bounds_of("v_unit")
    a_x_is_plausible = low <= by_a_x <= high
    words = {"unit": _read_as(radius / (by_a_x if a_x_is_plausible else NOMINAL_RADIUS))}
    yield Measured("v_unit", radius, words=words)
    if a_x_is_plausible:
        yield Measured("v_unit_by_a_x", radius / by_a_x, words=words)


def _sides(alone: str | None) -> dict[str, str]:
    """Text for the axle that should slip more, and for the other one."""
    more, less = ("rear", "front") if alone == "r" else ("front", "rear")
    return {"more": more, "less": less, "axle": less[0]}


def _read_as(factor: float) -> str:
    """The units that make a ``v`` that is ``factor`` times too large [1]."""
    for unit, read_as in permutations(_SPEEDS, 2):
        if factor > 0.0 and abs(math.log(factor * _SPEEDS[unit] / _SPEEDS[read_as])) < _UNIT_KNOWN:
            return f"v is in {unit} and was read as {read_as}"
    return "the unit of v or of the wheel speeds"


def radii(e: Evidence) -> Iterator[Measured]:
    """Ratios of the rolling radii of the axles (over the file's, if any) and of both sides."""
    axles, vehicle = e.run.axles, e.run.vehicle
    if axles is None:
        return
    eta = axles.front_rear
    if eta is not None:
        apart = eta.value if vehicle is None else vehicle.radius_mismatch(eta.value)
        yield Measured("eta_zero", apart, eta.half)
        yield Measured("eta_zero_uncertain", eta.half)
    for axle, sides in (("f", axles.left_right_f), ("r", axles.left_right_r)):
        if sides is not None:
            yield Measured(f"sides_{axle}", sides.value, sides.half)


def slip(e: Evidence) -> Iterator[Measured]:
    """Rise of eta under braking: the axle that brakes alone, else the front one, must slip more.

    Up to the deceleration to which the car is front-biased; without a vehicle, to the least one of
    any car that may be released.
    """
    run, b = e.run, e.run.blocks
    biased = front_biased_up_to(run.car) if run.vehicle else LEAST_FRONT_BIASED
    end = np.inf if run.alone else 0.8 * biased
    braked = np.flatnonzero(np.maximum(b.p_f, b.p_r) > BITE)
    bitten = float(b.end[braked[0]]) + SETTLE if braked.size else np.inf
    rise, error = eta_rise(b, (b.z > 0.1) & (b.z < end) & (b.end > bitten))
    yield Measured("eta_falls", -rise if run.alone == "r" else rise, error, words=_sides(run.alone))


def eta_rise(b: Blocks, use: Mask) -> tuple[float, float]:
    """Median of eta over ``use`` minus that of the lead-in, and its standard error, both [1].

    The median is robust against short locks. NaN with fewer than four blocks in a part, and where
    the torque of engine or motor, which moves eta too, differs between them.
    """
    if min(np.count_nonzero(use), np.count_nonzero(b.lead_in)) < 4:
        return np.nan, np.nan
    for drive in (b.drive_f, b.drive_r):
        if abs(float(np.median(drive[use]) - np.median(drive[b.lead_in]))) > LIMITS.steady_drive:
            return np.nan, np.nan
    sides = [b.eta[b.lead_in], b.eta[use]]
    free, braked = (float(np.median(side)) for side in sides)
    variance = sum(np.var(side, ddof=1) / side.size for side in sides)
    return braked - free, float(np.sqrt(0.5 * np.pi * variance))


def car_wheels(e: Evidence) -> Iterator[Measured]:
    """Rolling radii of the axles against those of the vehicle file."""
    if e.run.vehicle is None or (rolling := e.run.rolling_radii) is None:
        return
    car = e.run.car
    radii = [
        relative("rolling_radius_f", rolling[0], car.front.rolling_radius),
        relative("rolling_radius_r", rolling[1], car.rear.rolling_radius),
    ]
    off = min((radius.value for radius in radii), key=abs)
    likely = "a log of another vehicle"
    if abs(off) > bounds_of("a_x_scale")[1]:
        sensor = e.run.accelerometer(identify(car, ()))
        if math.sqrt(sensor.variance_scale) > 0.5 * abs(off):  # hardly braked
            likely = "the scale of v, or a log of another vehicle"
        elif -_MOST_OF_IT > sensor.scale / off > -1.0 / _MOST_OF_IT:
            likely = "the scale of v, by which a_x and v differ as much"
    yield from (replace(radius, words={"likely": likely}) for radius in radii)


def a_x_by_wheels(e: Evidence) -> Iterator[Measured]:
    """Scale of a_x without v: speed lost by its integral over that by the wheels, less 1.

    Zero and slope of a_x are those of the lead-in, slip is that of usual tyres. Taken at the block
    with the least error: the slower the car, the less the slip counts.
    """
    b = e.run.blocks
    rolled = np.flatnonzero(b.lead_in)
    if e.run.vehicle is None or b.v is not None or rolled.size * b.length < _ROLLED:
        return
    if e.run.clock.gaps:
        return
    car, (mean, sigma, *_) = e.run.car, CAR.compliance
    rim = 0.5 * (car.front.rolling_radius * b.omega_f + car.rear.rolling_radius * b.omega_r)
    time = b.end - b.end[rolled[-1]]
    slope, rim_at_first = np.polyfit(time[rolled], rim[rolled], 1)
    z = np.where(time > 0.0, b.z - np.mean(b.z[rolled]) - slope / G, 0.0)
    gained = G * b.length * np.cumsum(z)
    lost = rim_at_first - rim / (1.0 - mean * np.clip(z, 0.0, 1.0))
    ends = e.run.slipping.first if e.run.slipping else np.inf
    use = np.flatnonzero((time > 0.0) & (b.end < ends) & (rim > MOVING) & (lost > MOVING))
    if use.size:
        errs = np.hypot(rim * sigma * z, _OTHER_SLOPE * G * time)[use] / lost[use]
        i = use[np.argmin(errs)]
        usual = math.hypot(float(errs.min()), _RADIUS, LOG.a_x_scale.sigma)
        yield Measured(
            "a_x_by_wheels", float(gained[i] / lost[i]) - 1.0 - LOG.a_x_scale.mean, usual
        )


def slip_of_v(e: Evidence) -> Iterator[Measured]:
    """Slip of the braked wheels by v, rms, over the least of any tyre [1].

    It is zero where v is computed from the wheels of an axle, or of all four: the least of the
    three counts. The force on a braked axle is about its load times the deceleration, or more.
    """
    rolling, b, shares = e.run.rolling_radii, e.run.blocks, []
    if rolling is None:
        return
    braking = (b.speed > MOVING) & (b.drive_f == 0.0) & (b.drive_r == 0.0)
    braking &= (b.z > _BRAKED) & (b.z < GREATEST_Z)
    rims = np.stack([rolling[0] * b.omega_f, rolling[1] * b.omega_r])
    slips = 1.0 - rims / np.maximum(b.speed, MOVING)
    pressed = np.stack([b.p_f, b.p_r]) > BITE
    for source, weights in _MADE_OF.items():
        use = braking & np.all(pressed[np.array(weights) > 0.0], axis=0)
        if np.count_nonzero(use) * b.length >= _TIME:
            rms = float(np.sqrt(np.mean((weights @ slips[:, use]) ** 2)))
            shares.append((_STIFFEST * rms / float(np.mean(b.z[use])), source))
    if shares:
        share, source = min(shares)
        yield Measured("v_of_wheels", share, words={"source": f"the {source} wheels"})


def v_scale(e: Evidence) -> Iterator[Measured]:
    """Scale of a_x against v by a wrong unit, clock or filter; 0 if a sensor's is likelier."""
    other = e.run.other_scale
    yield Measured("v_scale", other / (1.0 - other))
