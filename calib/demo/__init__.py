"""The whole program on the sample logs."""
