"""The estimator of a table as C for an ECU, and as an FMU beside the simulated car."""
