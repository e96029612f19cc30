"""Exports: a table in the formats of ECU tools and other programs, and their readers."""
