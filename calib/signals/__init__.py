"""From a log to clean signals on one clock."""
