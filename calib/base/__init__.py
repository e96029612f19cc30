"""Errors, units, names, files and the statistics that no room owns."""
