"""The look-up table as a value: its curves, what they rest on, its invariants, and comparisons."""
