"""A log by its car: signals, blocks, noise and events, what the run is good for, and warnings."""
