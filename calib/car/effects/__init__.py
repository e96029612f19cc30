"""Named effects, one file each, and their catalogue."""
