"""Frames of a bus, decoded with a DBC."""
