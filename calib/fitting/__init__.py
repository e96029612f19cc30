"""From ramps to a table."""
