"""Files: written completely or not at all, opened within a bound, published as a set."""
