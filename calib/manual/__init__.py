"""The manual: its pages beside this file, read as text."""
