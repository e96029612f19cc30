"""Signals of a log: axle means, blocks, noise, brake events."""
