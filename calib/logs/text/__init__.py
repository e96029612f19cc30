"""Logs in text formats."""
