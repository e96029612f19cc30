"""Imported once by the server that workers are forked off, so that each is ready at once.

What the library imports only where it is used is named here: else every worker would import it.
"""

from importlib import import_module

for name in (
    "pyarrow.csv",
    "pyarrow.parquet",
    "scipy.linalg",
    "scipy.optimize",
    "scipy.signal",
    "scipy.special",
    "calib.checks.check",
    "calib.diagnosis.diagnose",
    "calib.fitting.fit",
    "calib.fleet.work",
    "calib.validation.validate",
):
    import_module(name)
