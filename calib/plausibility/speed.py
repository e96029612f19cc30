"""A reference speed that says nothing of this car: a run that holds one is not used."""

from collections.abc import Iterable

from calib.base.errors import LogError
from calib.base.warning import PlausibilityWarning

NO_SPEED = {
    "v_of_wheels": "v is computed from the wheel speeds",
    "v_scale": "v and a_x differ by a scale that no sensor has",
}
"""What is said of such a speed, by the code of its warning."""


def wrong_speed(warnings: Iterable[PlausibilityWarning]) -> PlausibilityWarning | None:
    """The first warning that v says nothing of the car; None where there is none."""
    return next((warning for warning in warnings if warning.code in NO_SPEED), None)


def require_measured_speed(warnings: Iterable[PlausibilityWarning]) -> None:
    """Raise LogError where a run is warned of a v that says nothing of the car."""
    if (wrong := wrong_speed(warnings)) is not None:
        raise LogError(
            f"{NO_SPEED[wrong.code]}: {wrong.text}",
            where=wrong.log,
            expected="a v and an a_x that agree on how the car slows, or no v",
            do="leave v out of the log: rename its column, or map it to no channel",
        )
