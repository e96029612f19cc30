"""Physical effects in addition to the paper's model, one file for each part of the car."""
