"""Batches of logs: one row for each log, computed on this machine or on a Dask cluster."""
