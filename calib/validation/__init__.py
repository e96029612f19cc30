"""The estimator on hold-out logs: metrics, limits, results."""
