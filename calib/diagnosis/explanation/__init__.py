"""A model of all runs: its prediction of the sensors, its prior, and its fit."""
