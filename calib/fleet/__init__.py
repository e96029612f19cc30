"""Many logs: one row a log, on this machine's cores or on a Dask cluster.

find ──> run ──> pool | cluster ──> work ──> row
           └───> journal (a row a log, as they finish) ──> results.parquet (sorted, at the end)
"""
