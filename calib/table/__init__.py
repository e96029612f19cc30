"""The look-up table: value, versions on disk, exports."""
