"""Qualification of the program on the user's own machine, against truths known beforehand."""
