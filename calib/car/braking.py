"""The two thresholds above which a car counts as braked and as moving, for all rooms."""

BITE = 1.5e5
"""Pressure [Pa] above which a brake counts as applied."""

MOVING = 3.0
"""Speed [m/s] below which wheel speed sensors and slip are too inexact."""
