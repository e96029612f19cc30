"""Quantities that a log can give, also if it has no brake pressure."""

from collections.abc import Iterator

from calib.base.names import AXLE_NAMES
from calib.run.limits import LIMITS
from calib.run.observation import Observation


def uses(seen: Observation) -> Iterator[str]:
    """Quantities that can be determined from a log, with their accuracy, in words."""
    axles = seen.axles
    if axles is None:
        return
    zero = axles.front_rear
    if zero is not None:
        enough = "fine" if zero.half <= LIMITS.table_zero else "too coarse"
        yield (
            f"the zero of eta to {100 * zero.half:.3f} % ({enough} for a table), if the car rolled "
            "without its engine"
        )
    if axles.slope is not None and axles.slope > 0:
        yield f"sign and size of a_x: with the wheels it makes a radius of {axles.slope:.2f} m"
    logged = [name for name in ("T_drive_f", "T_drive_r") if name in seen.present]
    if logged:
        yield f"brake forces less the torque of engine or motor: {', '.join(logged)}"
    if seen.alone:
        yield (
            f"the {AXLE_NAMES[seen.alone]} tyres' stiffness, and the pads' ratio, in a fit "
            "together with a ramp of both axles: the other axle has no pressure"
        )
    if seen.events and "p_mc" in seen.missing:
        yield f"deceleration and slip of {len(seen.events)} braking(s); without pressure no torque"
