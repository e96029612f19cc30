"""The thresholds above which a car counts as braked and as moving."""

BITE = 1.5e5  # pressure [Pa] above which a brake counts as applied
MOVING = 3.0  # speed [m/s] above which wheel speeds and slip are exact enough to be used
