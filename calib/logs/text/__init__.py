"""Logs that are text."""
