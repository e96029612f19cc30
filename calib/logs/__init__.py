"""One reader per file format; each returns a `Log`."""
