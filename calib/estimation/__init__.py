"""Validation of the estimator on hold-out logs: metrics, limits, results."""
