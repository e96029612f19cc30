"""Warnings on a usable log."""

import math
from collections.abc import Iterator

from calib.checks.observation import Observation
from calib.checks.rules import LEAD_IN_GOOD, LEAD_IN_VALIDATE, hanging

SLOW = 95.0
"""Lowest rate [Hz] that resolves the build-up of the brake, 0.1 to 0.2 s."""
RADII, TYRES = 1e-3, 8e-3
"""Mismatch of the axles [1] that costs 3 to 8 % of torque if not zeroed; that wear cannot cause."""
SIDES = 5e-3
"""Difference of left and right [1]: as in a bend of 300 m radius with a track of 1.5 m."""
ZERO = 5e-4
"""Uncertainty of eta [1] that is too large: eta rises by 0.1 to 0.8 %."""
FLAT = 0.85
"""Share of zeros without braking [1]; a noisy pressure sensor that is cut off at 0 has 2/3."""
STIFF = 500e5
"""Pressure per g [Pa] that is too high for any car."""


def warnings_of(seen: Observation) -> list[str]:
    """Warnings on a log, in words."""
    rules = (_clock, _lead_in, _radii, _swapped, _limits, _sensors, _pressure)
    return [text for rule in rules for text in rule(seen)]


def _clock(seen: Observation) -> Iterator[str]:
    clock = seen.clock
    if clock.rate < SLOW:
        yield f"{clock.rate:.4g} Hz is slow: 200 Hz shows the build-up of the brake"
    if clock.jitter * clock.rate > 0.1:
        yield f"the steps of the clock vary by {100 * clock.jitter * clock.rate:.0f} %"
    if clock.gaps:
        when, length = max(clock.gaps, key=lambda gap: gap[1])
        yield f"{len(clock.gaps)} gaps in time, the longest {length:.2f} s at {when:.2f} s"


def _lead_in(seen: Observation) -> Iterator[str]:
    if seen.events and LEAD_IN_VALIDATE <= seen.lead_in < LEAD_IN_GOOD:
        yield f"only {seen.lead_in:.2f} s of steady rolling at the start; 1 s zeroes eta better"
    if seen.lead_in_driven:
        yield "the car is accelerated before the braking: let it roll, driven wheels slip"
    if seen.standing > 0.0:
        yield f"the car stands for {seen.standing:.1f} s"


def _radii(seen: Observation) -> Iterator[str]:
    axles = seen.axles
    if axles is None:
        return
    eta = axles.front_rear
    if eta is None:
        yield "eta cannot be zeroed: nothing is driven without braking"
    else:
        if abs(eta.value) > max(RADII, eta.half):
            why = "different tyres front and rear?" if abs(eta.value) > TYRES else "it is zeroed"
            yield f"eta is {100 * eta.value:+.2f} % off without braking: {why}"
        if eta.half > ZERO:
            yield f"the zero of eta is known to {100 * eta.half:.2f} % only; eta rises by 0.1-0.8 %"
    for name, sides in (("front", axles.left_right_f), ("rear", axles.left_right_r)):
        if sides is not None and abs(sides.value) > max(SIDES, sides.half):
            yield f"the {name} wheels differ by {100 * sides.value:+.1f} %: a bend or unequal tyres"


def _swapped(seen: Observation) -> Iterator[str]:
    eta = seen.axles.eta_braked if seen.axles else None
    if eta is None:
        return
    more, less, sign = ("rear", "front", -1.0) if seen.alone == "r" else ("front", "rear", 1.0)
    if sign * eta.value < -max(ZERO, eta.half):
        yield (
            f"the {more} wheels slip less than the {less} while braking (eta "
            f"{100 * eta.value:+.2f} %): are the axles swapped?"
        )


def _limits(seen: Observation) -> Iterator[str]:
    slips = seen.slipping
    if slips and slips.cycles:
        wheels = ", ".join(dict.fromkeys(wheel for wheel, _ in slips.cycles))
        yield f"ABS works on {wheels} from {slips.cycles[0][1]:.2f} s on"
    if slips and slips.locked:
        yield f"wheel {', '.join(slips.locked)} locks"


def _sensors(seen: Observation) -> Iterator[str]:
    if "v" not in seen.present:
        yield "no reference speed v: slip stiffness and the ratio of the pads cannot be separated"
    for sensor in seen.sensors:
        if sensor.stuck and sensor.channel == "v":
            yield hanging(sensor)
        if sensor.saturated:
            yield f"{sensor.channel} stays at its extreme for {sensor.saturated:.2f} s: saturated?"
    blur = _blur(seen)
    if blur > ZERO:
        yield f"the wheel speeds are coarse: eta has noise of {100 * blur:.2f} % over 0.2 s"


def _blur(seen: Observation) -> float:
    """Standard deviation of eta in a mean over 0.2 s, from the wheels' noise and steps [1]."""
    wheels = [s for s in seen.sensors if s.channel.startswith("omega") and s.high > 0]
    noise = [
        math.hypot(s.noise, s.resolution / math.sqrt(12.0)) / s.high
        for s in wheels
        if not math.isnan(s.noise)
    ]
    # Two wheels make an axle and two axles make eta: the factors cancel.
    return max(noise, default=0.0) / math.sqrt(max(1.0, 0.2 * seen.clock.rate))


def _pressure(seen: Observation) -> Iterator[str]:
    pressure, a_x = seen.sensor("p_mc"), seen.sensor("a_x")
    if pressure is None or a_x is None or not seen.events:
        return
    if pressure.flat > FLAT and pressure.low == 0.0 and a_x.noise > 0.01:
        yield "p_mc is exactly 0 without braking, without noise: is it computed, not measured?"
    if seen.z > 0.1 and pressure.high / seen.z > STIFF:
        yield f"p_mc takes {pressure.high / seen.z / 1e5:.0f} bar for each g: is it a pressure?"
