"""The estimator of pad friction and brake torque, and the methods beside it."""
