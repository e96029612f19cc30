"""An explanation: a model of all runs, its prediction of the sensors, and its fit."""
