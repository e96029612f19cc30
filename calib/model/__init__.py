"""A ramp and a drive as a model predicts them; below fit and estimate."""
