"""Recordings of bus frames, decoded with a DBC."""
