"""When a car counts as braked and as moving: the two thresholds that every room shares."""

BITE = 1.5e5
"""Pressure [Pa] above which a brake is taken to be applied."""

MOVING = 3.0
"""Speed [m/s] below which wheel speed sensors and slip mean little."""
