"""What is in a log, whether it is usable, and for what."""
