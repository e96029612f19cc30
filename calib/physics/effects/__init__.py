"""Named causes: one file each, and the catalogue."""
