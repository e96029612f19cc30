"""Packages that are installed only on request, by extra: `pip install 'brake-cal[mdf]'`."""

from importlib import import_module
from types import ModuleType

from calib.base.errors import BrakeCalError
from calib.base.names import NAME

EXTRAS = {
    "mdf": "logs as MDF (.mf4, .mdf, .dat)",
    "can": "bus logs (.blf, .asc, .trc, candump) with DBC, ARXML, KCD or SYM",
    "sign": "signatures of tables",
    "dist": "batch on a Dask scheduler",
    "elf": "addresses of a linked program in an A2L",
    "frames": "results as data frames in Python",
}
"""Each extra, and what it adds for users."""


def need(
    module: str, extra: str, where: object = None, error: type[BrakeCalError] = BrakeCalError
) -> ModuleType:
    """Import and return ``module``, which comes with the ``extra``.

    If the module is missing, raises ``error``, which says what to install to use ``where``.
    """
    try:
        return import_module(module)
    except ModuleNotFoundError as cause:
        package = module.split(".")[0]
        if cause.name is None or cause.name.split(".")[0] != package:
            raise  # the package is installed, but lacks a package that it needs
        do = f"pip install '{NAME}[{extra}]', for {EXTRAS[extra]}"
        raise error(f"{package} is not installed", where=where, do=do) from cause
