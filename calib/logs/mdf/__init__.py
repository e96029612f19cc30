"""ASAM MDF 3 and 4."""
