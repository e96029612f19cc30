"""The gap between simulation and measurement: find its cause, name it, add it to the model."""
