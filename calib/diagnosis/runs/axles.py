"""Logs with front and rear wheel speeds exchanged, as if they had been swapped.

Where the rear wheels slip more than the front ones, the wheel speeds are swapped, or something
brakes the rear wheels, such as a motor, which is an effect with a name. Both are searched, and the
more probable one is believed:

    the logs as given      against      the logs with their axles exchanged
"""

from collections.abc import Collection, Sequence
from dataclasses import replace

from calib.logs.log import Log


def exchanged(logs: Sequence[Log], wrong: Collection[str]) -> list[Log]:
    """The logs with those exchanged whose names are ``wrong``, or every one if these are most."""
    most = 2 * len(wrong) > len(logs)
    return [_exchanged(log) if most or log.name in wrong else log for log in logs]


def _exchanged(log: Log) -> Log:
    """The log with the wheel speeds of the other axle."""
    other = {f"omega_{a}{side}": log[f"omega_{b}{side}"] for a, b in ("fr", "rf") for side in "lr"}
    return replace(log, channels=log.channels | other)
