"""Calibration of a brake-torque estimator from one ramped braking run."""

__version__ = "0.1.0"
