"""One reader per file format, all giving one `Log`."""
