"""What the resistance that a fit has found says against the car or a_x."""

from collections.abc import Iterator

from calib.base.warning import PlausibilityWarning
from calib.plausibility.limits import PLAUSIBLE


def resistance_warnings(
    vehicle: str, coefficient: float, sigma: float
) -> Iterator[PlausibilityWarning]:
    """A rolling ``coefficient`` [1], known to ``sigma``, that no tyre has.

    What brakes the car in all runs is taken for its resistance, and taken out of all of them.
    """
    if coefficient > PLAUSIBLE.resistance + sigma:
        yield PlausibilityWarning(
            "rolling_resistance",
            vehicle,
            coefficient,
            (0.0, PLAUSIBLE.resistance),
            (
                "an engine in gear, a motor that brakes or a brake that drags, in all runs",
                "the zero or the mounting of a_x",
                "a soft or loose road, tyres without air",
            ),
            "roll in neutral with the brakes free, or log T_drive_f and T_drive_r; zero a_x on "
            "level ground; if the car is like this, give the effect rolling_resistance in its file",
        )
