"""All that one run says against its sensors, from fit, estimate and diagnosis alike.

A quantity of the run, its sigma, and the range of its code in `base/warnings.csv`: what lies
outside is told. Nothing here changes an estimate.
"""

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from calib.base.errors import LogError
from calib.base.intervals import QUARTILE
from calib.base.mixtures import likelihood_ratio
from calib.base.names import AXLES, WHEELS, G
from calib.base.units import from_si
from calib.base.warning import Measured, PlausibilityWarning, judged, relative
from calib.car.balance import brake_forces
from calib.car.braking import BITE, MOVING
from calib.car.forces import axle_loads
from calib.car.vehicle import Vehicle
from calib.run.accelerometer import Accelerometer
from calib.run.axle_signals import held_time
from calib.run.blocks import Blocks
from calib.run.brake_response import BrakeResponse
from calib.run.copies import twice
from calib.run.driving_record import NOMINAL_RADIUS
from calib.run.lateral import lateral, sides
from calib.run.run import Run
from calib.run.warnings import impossible_samples

_COMPARED = (*(f"omega_{w}" for w in WHEELS), "v", "a_x", "p_mc")

_WANDERS = 0.5  # chance of a slope that changes from which it is named [1]
_MOTOR, _STATED = 0.67, 0.01
"""Odds of a motor from which it is named [1]: what is named too often costs a look, a motor that is
not named stands in the pads. Least odds of one before the run: files that have none err, too."""
_FORCE = 0.1  # spread of a motor's force over the usual brake force [1]: 0.01 to 0.1 g beside 0.3 g
_USUAL, _FADING = 0.015, 0.02
"""Spread of a force without pressure, and of one that goes with the speed, where nothing but the
pads brakes [1]: the pressure at which pads bite and the zero of p_mc within 0.5 bar, over 30 bar;
slow noise in the half second below 3 m/s. Pads that grip more as they get slow are below zero."""
_STIFFEST = 60.0  # slip stiffness over load [1] that no tyre has
_BRAKED = 0.05  # nominal brake force of an axle over its load [1] from which its slip is seen
_MADE_OF = {"front": (1.0, 0.0), "rear": (0.0, 1.0), "four": (0.5, 0.5)}
"""Weights of the front and rear wheels that v may be made of."""
_PRESSED = 20e5  # pressure from which sensors, left and right, agree as one to the other [Pa]
_TIME = 1.0  # time of such braking, or of rolling, that is needed [s]
_SPAN, _SIGMA = 11, 5.0
"""Samples of the median from which a lost pulse stands out; the distance below it, in its usual
scatter, or in 0.1 % of the speed, that noise does not have."""
_UPRIGHT = 0.1
"""Deceleration [1] past which left and right are not compared: the inner wheels of a bend bear less
and slip more, which looks like a tighter one."""
NO_SPEED = ("v_of_wheels", "v_scale")  # codes of a v that says nothing of the car


def run_warnings(
    run: Run, vehicle: Vehicle, sensor: Accelerometer, response: BrakeResponse | None
) -> tuple[PlausibilityWarning, ...]:
    """Warnings on a run.

    ``vehicle`` with the pads that are expected; ``sensor`` the accelerometer as judged over the
    run; ``response`` of its brakes to the pressure.
    """
    brakes = of_brakes(response, vehicle.motor_odds) if response else ()
    measured = *of_channels(run), *of_wheels(run, vehicle), *of_accelerometer(sensor), *brakes
    return (*impossible_samples(run.log), *judged(run.log.name, measured))


def of_channels(run: Run) -> Iterator[Measured]:
    """One signal twice, values that are held or late, pressures at rest or on one side."""
    log, s = run.log, run.signals
    for one, other, same in twice(log, [name for name in _COMPARED if name in log]):
        yield Measured("same_signal", same, words={"one": one, "other": other})
    yield Measured("v_held", held_time(log))
    yield Measured("wheels_held", run.wheels_held)
    if s.delay.late:
        used = "v was put in time" if s.delay.sharp else "v is not used"
        yield Measured("v_late", s.delay.value, words={"used": used})
    if s.lead_in.any():
        zero = max((float(np.mean(p[s.lead_in])) for p in (s.p_f, s.p_r)), key=abs)
        yield Measured("pressure_zero", from_si(zero, "bar", "Pa"))
    for axle in AXLES:
        words = {"left": f"p_{axle}l", "right": f"p_{axle}r"}
        if set(words.values()) <= log.channels.keys():
            left, right = (float(np.max(log[name])) for name in words.values())
            apart = (left - right) / max(left, right, _PRESSED)
            yield Measured("pressure_sides", apart, words=words)


def of_wheels(run: Run, vehicle: Vehicle) -> Iterator[Measured]:
    """Wheels of another size, slip that v does not show, pulses that a wheel loses."""
    if (radii := run.rolling_radii) is not None:
        yield relative("rolling_radius_f", radii[0], vehicle.front.rolling_radius)
        yield relative("rolling_radius_r", radii[1], vehicle.rear.rolling_radius)
        yield from _slip_of_v(vehicle, run.blocks, radii)
    yield from _lost_pulses(run)


def _slip_of_v(vehicle: Vehicle, b: Blocks, radii: tuple[float, float]) -> Iterator[Measured]:
    """Slip of an axle while it brakes, by v, over the least that any tyre has [1] (rms).

    Of v from one axle that slip is zero, of v from all wheels the mean of both: the least of the
    three. An axle that is not braked for long says nothing.
    """
    loads, found = axle_loads(vehicle, b.z), []
    told = (b.speed > MOVING) & (b.drive_f == 0.0) & (b.drive_r == 0.0)
    told &= np.minimum(*loads) > 0.0  # else a glitch of a_x
    rims = np.stack([radii[0] * b.omega_f, radii[1] * b.omega_r])[:, told]
    brakes = np.stack(brake_forces(vehicle, b.p_f, b.p_r))[:, told]
    slips, forces = 1.0 - rims / b.speed[told], brakes / np.stack(loads)[:, told]
    for source, weights in _MADE_OF.items():
        slip, force = weights @ slips, weights @ forces
        braked = force > _BRAKED
        if np.count_nonzero(braked) * b.length >= _TIME:
            rms = np.sqrt(np.mean(slip[braked] ** 2))
            found.append((float(_STIFFEST * rms / np.mean(force[braked])), source))
    if found:
        share, source = min(found)
        yield Measured("v_of_wheels", share, words={"source": f"the {source} wheels"})


def _lost_pulses(run: Run) -> Iterator[Measured]:
    """Share of the unbraked samples in which one wheel alone is far below its usual course [1].

    A pulse that is lost lowers one reading by a tooth of 48 or so. Bumps lift and lower a wheel
    alike, so twice the share above is taken off; a wheel that slips is below for longer than the
    median spans.
    """
    from scipy.ndimage import median_filter

    s = run.signals
    rolling = (s.lead_in | (np.maximum(s.p_f, s.p_r) < BITE)) & (s.speed > MOVING)
    if np.count_nonzero(rolling) * s.sample_time < _TIME:
        return
    for name in (f"omega_{wheel}" for wheel in WHEELS):
        omega = run.log[name][rolling]
        away = omega - median_filter(omega, _SPAN)
        usual = float(np.median(np.abs(away))) / QUARTILE
        far = _SIGMA * max(usual, 1e-3 * float(np.mean(omega)))
        lost = float(np.mean(away < -far) - 2.0 * np.mean(away > far))
        yield Measured("lost_pulses", max(lost, 0.0), words={"wheel": name})


def of_bend(ramp: Run, straight: Sequence[Run]) -> Iterator[Measured]:
    """Mean lateral acceleration of a ramp [m/s^2] by runs of the same car that are ``straight``.

    Without such runs a bend and wheels of unlike radius look the same.
    """
    s, logs = ramp.signals, [run.corrected.log for run in straight]
    told = (s.speed > MOVING) & (s.z < _UPRIGHT)
    if straight and told.any():
        fast = 2.0 * MOVING / NOMINAL_RADIUS
        equal = [sides(log)[log["omega_rl"] + log["omega_rr"] > fast] for log in logs]
        zero = float(np.mean(np.concatenate(equal)))
        turned = lateral(ramp.corrected.log, s, ramp.car.track_width, zero)
        yield Measured("bend", float(np.mean(turned[told])))


def of_accelerometer(sensor: Accelerometer) -> Iterator[Measured]:
    """Scale, slope, offset, drag and delay."""
    if (other := sensor.other_scale) != 0.0:
        yield Measured("v_scale", other / (1.0 - other))
    else:
        scale = sensor.scale / (1.0 - sensor.scale)
        yield Measured("a_x_scale", scale, math.sqrt(sensor.variance_scale))
    if sensor.wanders > _WANDERS:
        yield Measured("a_x_against_v", sensor.disagrees)
    yield Measured("a_x_offset", -G * sensor.bias, G * math.sqrt(sensor.variance_bias))
    yield Measured("unexplained_drag", G * sensor.drag)
    yield Measured("a_x_late", sensor.lag, math.sqrt(sensor.variance_lag))


def of_brakes(response: BrakeResponse, odds: float) -> Iterator[Measured]:
    """Force without pressure, a step of it, and delay; ``odds`` of a motor before the run [1].

    A motor shows as force without pressure where it brakes from the first pressure on, as a force
    that goes with the speed where it hands over to the brakes before the car stands; each of them,
    and both, are as likely. A run that is not braked down to 3 m/s says nothing of the second.
    """
    share, late = response.share, response.fading
    one = likelihood_ratio(share, math.hypot(response.share_sigma, _USUAL), _FORCE)
    other = likelihood_ratio(late, math.hypot(response.fading_sigma, _FADING), _FORCE)
    if max(odds, _STATED) * (one + other + one * other) / 3.0 > _MOTOR:
        yield Measured("unexplained_braking_force", share if one > other else late)
    yield Measured("braking_force_missing", share, response.share_sigma)
    at, step, scatter = response.step
    yield Measured("force_step", step, scatter, words={"at": at})
    yield Measured("pressure_lag", response.delay, response.delay_sigma)


def wrong_speed(warnings: Iterable[PlausibilityWarning]) -> LogError | None:
    """The error of a run that is warned of a v that says nothing of the car; None of another."""
    do = "leave v out of the log: rename its column, or map it to no channel"
    for one in warnings:
        if one.code in NO_SPEED:
            return LogError("v is no speed of the car", where=one.log, do=do, lines=(str(one),))
    return None
