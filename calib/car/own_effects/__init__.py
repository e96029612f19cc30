"""Effects of the user's own, from a Python file."""
