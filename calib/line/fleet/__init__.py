"""Batches of logs: one row for each log, computed on this machine or on a Dask cluster.

find ──> run ──> pool | cluster ──> work ──> row
           └───> journal (rows as logs finish) ──> results.parquet (sorted, at the end)
"""
