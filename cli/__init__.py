"""The command line: thin commands over `calib`."""
