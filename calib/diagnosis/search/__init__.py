"""The search for the effects, the groups of logs and the radii that explain the logs."""
