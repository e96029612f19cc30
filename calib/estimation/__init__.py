"""The estimator on a log, its baselines, and the judgement of both: metrics, limits, results."""
