"""Simulation of the car, and replay of logs."""
