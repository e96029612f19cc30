"""What the resistance that a fit has found says against the car or a_x."""

from collections.abc import Iterator

from calib.base.warning import PlausibilityWarning, warning
from calib.plausibility.limits import PLAUSIBLE


def resistance_warnings(
    vehicle: str, coefficient: float, sigma: float
) -> Iterator[PlausibilityWarning]:
    """A rolling ``coefficient`` [1], known to ``sigma``, that no tyre has.

    What brakes the car in all runs is taken for its resistance, and taken out of all of them.
    """
    if coefficient > PLAUSIBLE.resistance + sigma:
        yield warning("rolling_resistance", vehicle, coefficient, (0.0, PLAUSIBLE.resistance))
