"""The manual, the demo, and whether the program works here: `qualify`."""
