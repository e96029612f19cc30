"""Errors, units, names, files and statistics that all other packages of `calib` use."""
