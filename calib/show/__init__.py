"""Plots: functions that make matplotlib figures of records. None is shown on a screen."""
