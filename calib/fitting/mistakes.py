"""Which mistake explains a ramp better than pads, tyres and car alone do: motors, their torque.

A mistake is a hypothesis with a forward model of one or two numbers, and odds before the ramp. The
ramp is asked how well each of them predicts it, over all sizes that it may have:

    brakes = level N(pressure) (1 + departure) + force of the mistake       the sum, (5), (17)
    tyres of the axles -> slips -> eta                                      the split, (13) to (22)

    ln odds = ln odds before + ln of the evidence of both, less that of no mistake

Pads that are not those of the vehicle file, in front, behind or on both axles, are hypotheses too:
a mistake is named only where it explains more than they do. Where even the best of all explains
badly, nothing on the list is the cause, and nothing is named. Two mistakes at once are not asked
for; a gain of p_mc is one with pads of another friction.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from calib.base.arrays import Array
from calib.base.names import AXLE_NAMES, AXLES, G
from calib.base.warning import Measured
from calib.car.balance import brake_forces, front_share
from calib.car.beliefs import CAR, STOP
from calib.car.effects.hydraulics import limited
from calib.car.forces import mean_slip
from calib.car.vehicle import Axle, Vehicle
from calib.fitting.ensemble import Ensemble, spread_evenly
from calib.fitting.known import OWN, drawn
from calib.fitting.regression import Regression
from calib.model.ramp import RampRun

SURE, CERTAIN = 3.0, 8.0
"""ln of the odds over all else from which a mistake is named, and from which it is believed: 20 and
3,000 to 1. A car near ideal balance on tyres of a form of its own had 6.4 without a motor."""

_EXPLAINED = 2.5
"""Mean square of what the best leaves of eta, slip and sum, over their errors, past which nothing
on the list explains the ramp."""

_MOSTLY = 8.0
"""The same of what leaves less than 0.4 of what nothing wrong does: few draws are exact."""

_DRAWS = 512
_BROAD = 0.5  # sigma of ln of the pads' ratio of the draws: any pads
_PADS = 0.1  # sigma of ln of the friction of an axle's pads against the file
_OTHER = 0.5  # the same where the file is not that of the car
_POINTS = 14  # of the sum of forces of a ramp
_TREND = 0.05  # sigma of how the level of the pads changes over a ramp [1]
_DEPARTS, _LENGTH = 0.015, 0.15
"""How far pads depart from a friction that is constant [1], alike over this deceleration [1]."""
_ZERO = 0.002  # sigma of the zero of the sum of forces over the weight [1]

_FACTORS = (-2.0, -1.0, 0.0, 0.5, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, *map(float, range(6, 13)), 14.0)
"""Factors on a logged torque: another sign, one motor of two or three, the shaft of a gear."""
_TORQUES = (150.0, 250.0, 400.0, 600.0, 900.0, 1300.0)  # of a motor, at the wheels of an axle [N m]
_FULL = (4e5, 10e5, 20e5)  # pressures at which it gives them [Pa]
_HANDS_OVER = (1.0, 4.0)  # speeds between which it hands over to the brakes [m/s]
_KNEES, _SLOPES = (10e5, 15e5, 20e5, 25e5, 30e5), (0.2, 0.45)  # of a valve [Pa], [1]
_LEAST_DRIVE = 20.0  # torque that is logged while a car brakes [N m]: less is noise
_FIRST = {1: ((-1.0,), (2.0,), (9.0,)), 2: ((250.0, 8e5), (700.0, 12e5))}
_FIRST_DELAYS, _FIRST_DRAGS = ((0.03,), (0.07,)), ((2e5,), (4.5e5,))
_FIRST_KNEES = ((15e5, 0.3), (25e5, 0.3))
"""Sizes that are tried first: of a factor, of a motor, of a delay, of a drag, of a valve."""
_NEVER = -1e6  # ln of the odds of what explains nothing at all
_NEAR = 6.0  # ln of the odds against a mistake from which on no other size of it is tried

_DELAYS = (0.012, 0.02, 0.03, 0.045, 0.07, 0.1)  # by which the wheel speeds of an axle are late [s]
_DRAGS = (1e5, 2e5, 3e5, 4.5e5, 7e5)  # pressures that are left in one brake of an axle [Pa]

SCALE, MOTOR, VALVE = "drive_torque_scale", "motor_not_logged", "rear_pressure_limited"
LATE, DRAG = "wheels_late", "brake_drags"
"""Codes of `rules.csv`."""

_IN_WORDS = {
    MOTOR: "a motor that brakes the {axle} wheels by up to {size:.0f} N m, and is not logged",
    LATE: "wheel speeds of the {axle} axle that are late by {size:.3f} s",
}

Size = tuple[float, ...]


@dataclass(frozen=True)
class Hypothesis:
    """A mistake by its ``code`` of `rules.csv`; empty of nothing wrong, and of other pads.

    ``odds`` before the ramp [1]; ``sizes`` that it may have, equally likely, of which the ``first``
    are tried before all; ``undo`` makes of a run what it is without the mistake; ``pads`` sigma of
    ln of the friction of the front and the rear pads against the file [1].
    """

    code: str
    odds: float
    sizes: tuple[Size, ...] = ((),)
    first: tuple[Size, ...] = ((),)
    undo: Callable[[RampRun, Size], RampRun] | None = None
    pads: tuple[float, float] = (_PADS, _PADS)
    axle: str = ""


@dataclass(frozen=True)
class Cause:
    """A hypothesis with its ``log_odds`` over nothing wrong, and the likeliest ``size``.

    ``misfit`` mean square of what it leaves over its errors [1].
    """

    hypothesis: Hypothesis
    log_odds: float
    size: Size
    misfit: float


def causes_of(car: Vehicle, runs: Sequence[RampRun], other_road: bool = False) -> tuple[Cause, ...]:
    """The hypotheses on ramps ``runs`` with both axles, most probable first.

    Stops are as good as ramps, and may be on an ``other_road``.

    Raises ValueError where nothing is left of a ramp.
    """
    evidence = _Evidence(car, runs, other_road)
    nothing = evidence.cause(Hypothesis("", 1.0), -math.inf)
    base = nothing.log_odds
    causes = (nothing, *(evidence.cause(h, base) for h in _hypotheses(car, runs)))
    compared = (replace(cause, log_odds=cause.log_odds - base) for cause in causes)
    return tuple(sorted(compared, key=lambda cause: -cause.log_odds))


def _set(causes: Sequence[Cause]) -> tuple[Cause, ...]:
    """What the ramps leave, most probable first; none where nothing wrong, or nothing, explains
    them.
    """
    best = causes[0]
    sure = SURE * max(best.misfit, 1.0)  # what leaves more than its errors is as much less sure
    near = tuple(c for c in causes if c.log_odds > best.log_odds - sure)
    usual = (_PADS, _PADS)
    nothing = next(c.misfit for c in causes if not c.hypothesis.code and c.hypothesis.pads == usual)
    most = max(_EXPLAINED, min(_MOSTLY, nothing / 2.5))
    return near if best.misfit < most and best.log_odds > sure else ()


def named(causes: Sequence[Cause], beside_pads: bool = True) -> tuple[Cause, ...]:
    """The mistakes that the ramps leave, most probable first.

    ``beside_pads`` where other pads are left, too: a ramp has those of the file, a stop may be wet.
    """
    near = _set(causes)
    mistakes = tuple(c for c in near if c.hypothesis.code)
    return mistakes if beside_pads or len(mistakes) == len(near) else ()


def certain(causes: Sequence[Cause]) -> bool:
    """Whether a mistake is believed: no pads explain the ramps as well."""
    near = _set(causes)
    return bool(near) and near[0].log_odds > CERTAIN and all(c.hypothesis.code for c in near)


def other_than_pads(causes: Sequence[Cause]) -> str:
    """A mistake that explains ramps nearly as well as other pads do, in words; "" for none."""
    best = max(c.log_odds for c in causes if not c.hypothesis.code)
    near = (c for c in causes if c.hypothesis.code in _IN_WORDS and c.log_odds > best - SURE)
    for cause in near:
        axle = AXLE_NAMES[cause.hypothesis.axle]
        return _IN_WORDS[cause.hypothesis.code].format(axle=axle, size=cause.size[0])
    return ""


def measured(causes: Sequence[Cause], beside_pads: bool = True) -> Iterator[Measured]:
    """What the rules are told of the mistakes that are named."""
    for cause in named(causes, beside_pads):
        axle, size = cause.hypothesis.axle, cause.size
        words = {"axle": AXLE_NAMES[axle], "channel": f"T_drive_{axle}"}
        if cause.hypothesis.code == SCALE:
            words |= {"factor": f"{size[0]:.3g}", "cause": _why(size[0])}
            yield Measured(SCALE, size[0], words=words)
        elif cause.hypothesis.code == LATE:
            yield Measured(LATE, size[0], words=words)
        elif cause.hypothesis.code == DRAG:
            yield Measured(DRAG, size[0] / 1e5, words=words)
        elif cause.hypothesis.code == MOTOR:
            yield Measured(MOTOR, size[0], words=words | {"bar": f"{size[1] / 1e5:.0f}"})
        else:
            yield Measured(VALVE, 1.0, words={"bar": f"{size[0] / 1e5:.0f}"})


def _why(factor: float) -> str:
    """What makes of a torque at the wheels another one by a factor."""
    if factor < 0.0:
        return "another sign: what slows the car is negative"
    if factor < 1.0:
        return "a torque that is asked for, not the one that acts"
    several = "one motor of several, where the torque of all is meant"
    shaft = "the torque at the shaft of a motor, where that at the wheels is meant"
    return several if factor < 3.5 else shaft


def _hypotheses(car: Vehicle, runs: Sequence[RampRun]) -> Iterator[Hypothesis]:
    """All but the one that nothing is wrong, with which they are compared."""
    for pads in ((_OTHER, _PADS), (_PADS, _OTHER), (_OTHER, _OTHER)):
        yield Hypothesis("", 0.1, pads=pads)
    for axle, brake in zip(AXLES, (car.front, car.rear), strict=True):
        radius = brake.rolling_radius
        delays, drags = (tuple((x,) for x in sizes) for sizes in (_DELAYS, _DRAGS))
        yield Hypothesis(LATE, 0.01, delays, _FIRST_DELAYS, _in_time(car, axle), axle=axle)
        undo = _without(axle, _dragging(brake))
        yield Hypothesis(DRAG, 0.004, drags, _FIRST_DRAGS, undo, axle=axle)
        logged = [np.abs(getattr(run.blocks, f"drive_{axle}")[run.braked]) for run in runs]
        if max(float(np.max(x, initial=0.0)) for x in logged) > _LEAST_DRIVE:
            factors = tuple((factor,) for factor in _FACTORS)
            undo = _without(axle, _scaled(axle, radius))
            yield Hypothesis(SCALE, 0.1, factors, _FIRST[1], undo, axle=axle)
        if car.motor_odds > 0.0:
            torques = tuple((torque, full) for torque in _TORQUES for full in _FULL)
            undo = _without(axle, _motor(radius))
            yield Hypothesis(MOTOR, car.motor_odds, torques, _FIRST[2], undo, axle=axle)
    apart = any(not np.array_equal(run.blocks.p_f, run.blocks.p_r) for run in runs)
    if not apart and "rear_proportioning" not in car.effects:
        knees = tuple((knee, slope) for knee in _KNEES for slope in _SLOPES)
        yield Hypothesis(VALVE, 0.1, knees, _FIRST_KNEES, _limited, axle="r")


_Force = Callable[[RampRun, Size], Array]
"""Force [N] at the road (k,) that slows the wheels of an axle, and that the log does not have."""


def _without(axle: str, force: _Force) -> Callable[[RampRun, Size], RampRun]:
    """Count a ``force`` on the wheels of an axle as one that is known."""

    def undo(run: RampRun, size: Size) -> RampRun:
        own, name = force(run, size), f"moment_{axle}"
        more = {name: getattr(run, name) + own, "brake_sum": run.brake_sum - own}
        return replace(run, **more)

    return undo


def _scaled(axle: str, radius: float) -> _Force:
    """Of a logged torque that is another one by a factor."""

    def force(run: RampRun, size: Size) -> Array:
        drive: Array = getattr(run.blocks, f"drive_{axle}")
        return np.asarray((1.0 - size[0]) * drive * run.braked / radius)

    return force


def _motor(radius: float) -> _Force:
    """Of a motor that brakes along with the pedal, up to a torque, and hands over to the brakes."""

    def force(run: RampRun, size: Size) -> Array:
        b, (torque, full), (low, high) = run.blocks, size, _HANDS_OVER
        share = np.clip(np.maximum(b.p_f, b.p_r) / full, 0.0, 1.0)
        share *= np.clip((b.speed - low) / (high - low), 0.0, 1.0)
        return np.asarray(torque / radius * share * run.braked)

    return force


def _dragging(brake: Axle) -> _Force:
    """Of one wheel's brake in which a pressure is left, until the pedal gives more."""
    gain = brake.torque_gain * brake.pad_friction / brake.rolling_radius

    def force(run: RampRun, size: Size) -> Array:
        pressure = np.maximum(run.blocks.p_f, run.blocks.p_r)
        return np.asarray(gain * np.maximum(size[0] - pressure, 0.0))

    return force


def _in_time(car: Vehicle, axle: str) -> Callable[[RampRun, Size], RampRun]:
    """Put the wheel speeds of an axle in time: late ones are those of a faster car."""
    radius = (car.front if axle == "f" else car.rear).rolling_radius

    def undo(run: RampRun, size: Size) -> RampRun:
        b, name = run.blocks, f"omega_{axle}"
        omega = getattr(b, name) - size[0] * G * b.z / radius
        b = replace(b, **{name: omega})
        slip = None if b.v is None else mean_slip(car, run.load_f, b.omega_f, b.omega_r, b.v)
        return replace(run, blocks=b, slip=slip)

    return undo


def _limited(run: RampRun, size: Size) -> RampRun:
    """With the rear pressure that a valve leaves."""
    return replace(run, blocks=replace(run.blocks, p_r=limited(run.blocks.p_r, *size)))


def _top(sizes: Sequence[Size], log: Array, best: int) -> float:
    """The first number of the best size, where a parabola through its neighbours has its top."""
    first, *others = sizes[best]
    line = sorted(
        (size[0], each)
        for size, each in zip(sizes, log.tolist(), strict=True)
        if [*size[1:]] == others
    )
    middle = line.index((first, float(log[best])))
    near = np.array(line[max(middle - 1, 0) : middle + 2])
    if len(near) < 3:
        return first
    bend, slope, _ = np.polyfit(near[:, 0] - first, near[:, 1], 2)
    return float(first - 0.5 * slope / bend) if bend < 0.0 else first


@cache
def _draws(other_road: bool) -> tuple[Ensemble, Array, Array]:
    """Draws of the field whose pads have any ratio, with centre and root of what is linear.

    Every second one on an ``other_road``, as a stop may have it.
    """
    from scipy.special import ndtri

    x = ndtri(spread_evenly(_DRAWS, OWN + 1))
    e, centre, root = drawn(x[:, :OWN], ())
    e = replace(e, log_pad_ratio=_BROAD * x[:, -1])
    if other_road:
        (_, mean), (_, sigma) = STOP.log_peak.mean, STOP.log_peak.sigma
        place = (np.log(e.peak) - CAR.peak.mean) / CAR.peak.sigma
        log_peak = np.where(np.arange(e.size) % 2, mean + sigma * place, np.log(e.peak))
        stiff = STOP.log_stiffness.mean[1] + 0.25 * (log_peak - math.log(0.9))
        softer = np.where(np.arange(e.size) % 2, np.exp(-stiff), 1.0)
        centre[:, :2] *= softer[:, None]
        root[:, :2] *= softer[:, None, None]
        e = replace(e, peak=np.exp(log_peak))
    return e, centre, root


class _Evidence:
    """The evidence of hypotheses on the ramps of a car."""

    def __init__(self, car: Vehicle, runs: Sequence[RampRun], other_road: bool) -> None:
        self.car, self.runs, self.draws = car, runs, _draws(other_road)
        self.regression, self.share = Regression(car, list(runs)), front_share(car, 0.0)

    def cause(self, h: Hypothesis, nothing: float) -> Cause:
        """The hypothesis with ln of its odds times its evidence, and the size that has most.

        ``nothing`` is ln of the evidence of nothing wrong.
        """
        from scipy.special import logsumexp

        fits = {size: self._of(h, size) for size in h.first}
        if h.sizes != h.first and max(fits.values())[0] > nothing - _NEAR:
            fits = {size: fits.get(size) or self._of(h, size) for size in h.sizes}
        sizes, each = tuple(fits), np.array([log for log, _ in fits.values()])
        best = int(np.argmax(each))
        log = float(logsumexp(each)) - math.log(each.size) + math.log(h.odds)
        size = (_top(sizes, each, best), *sizes[best][1:]) if sizes[best] else ()
        log = max(log, _NEVER)  # of what no draw explains
        return Cause(h, log, size, fits[sizes[best]][1])

    def _of(self, h: Hypothesis, size: Size) -> tuple[float, float]:
        """ln of the evidence of one size, and the mean square that its best draw leaves."""
        from scipy.special import logsumexp

        runs = [h.undo(run, size) if h.undo else run for run in self.runs]
        sums = [self._sum(run) for run in runs]
        level = float(np.mean([level for _, level, _ in sums]))
        e, centre, root = self.draws
        regression = self.regression.with_forces_of(runs)
        split, mean, _ = regression.solve(e, centre, root)
        each = split + self._prior(level, e.log_pad_ratio, h.pads)
        best = int(np.argmax(each))
        front, rear, fall = (centre[best] + root[best] @ mean[best])[:, None]
        one = replace(
            e.take(np.array([best])), compliance_f=front, compliance_r=rear, radius_load=fall
        )
        rest = regression.left(one)[0] @ regression.white.T
        square = sum(square for _, _, square in sums) + float(rest @ rest)
        log = float(logsumexp(each)) - math.log(each.size) + sum(log for log, _, _ in sums)
        return log, square / (rest.size + _POINTS * len(runs))

    def _prior(self, level: float, ratio: Array, pads: tuple[float, float]) -> Array:
        """ln of the density of pads of a ``level`` and ``ratio`` (n,), over that of the draws."""
        front = (level + (1.0 - self.share) * ratio) / pads[0]
        rear = (level - self.share * ratio) / pads[1]
        less = 0.5 * (ratio / _BROAD) ** 2 + math.log(_BROAD)
        return np.asarray(less - 0.5 * (front**2 + rear**2) - math.log(pads[0] * pads[1]))

    def _sum(self, run: RampRun) -> tuple[float, float, float]:
        """ln of the evidence of the sum of forces, ln of the level of the pads, and the rest."""
        b, at = run.blocks, np.flatnonzero(run.braked)
        groups = np.array_split(at, min(_POINTS, at.size))
        front, rear = brake_forces(self.car, b.p_f, b.p_r)
        means = (front + rear, run.braking, b.z * self.car.weight, b.end)
        N, y, z, time = (
            np.array([float(np.mean(x[g])) for g in groups]) / scale
            for x, scale in zip(means, (*[self.car.weight] * 3, 1.0), strict=True)
        )
        length = np.array([g.size for g in groups]) * b.length
        near = np.exp(-0.5 * ((z[:, None] - z) / _LENGTH) ** 2)
        along = (time - time.mean()) / max(float(np.ptp(time)), b.length) * N
        covariance = np.diag(run.noise.z**2 / length) + np.outer(N, N) * _DEPARTS**2 * near
        covariance += np.outer(along, along) * _TREND**2 + _ZERO**2
        root = np.linalg.cholesky(covariance)
        w, v = np.linalg.solve(root, N), np.linalg.solve(root, y)
        level = float(w @ v / (w @ w))
        left = v - level * w
        square = float(left @ left)
        log = -0.5 * (square + math.log(w @ w)) - float(np.log(np.diag(root)).sum())
        return log, math.log(max(level, 1e-2)), square
