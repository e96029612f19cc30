"""Imports of the server from which workers are forked, so that workers start fast.

Modules that the library imports late are imported here once, instead of in every worker.
"""

from importlib import import_module

for name in (
    "pyarrow.csv",
    "pyarrow.parquet",
    "scipy.linalg",
    "scipy.optimize",
    "scipy.signal",
    "scipy.special",
    "calib.run.check",
    "calib.diagnosis.diagnose",
    "calib.fitting.fit",
    "calib.line.fleet.work",
    "calib.estimation.validate",
):
    import_module(name)
