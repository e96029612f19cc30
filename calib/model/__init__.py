"""A ramp as the model of a car has it, and simulated drives: inputs of fit and estimation."""
