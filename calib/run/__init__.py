"""Checks of a log: its content, and the purposes it is usable for."""
