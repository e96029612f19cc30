"""Import of libraries that only some formats need."""

import importlib
from types import ModuleType

from calib.errors import LogError


def need(module: str, extra: str, where: str) -> ModuleType:
    """Import ``module``; raise LogError naming the extra to install if it is missing."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as cause:
        if cause.name is None or cause.name.split(".")[0] != module.split(".")[0]:
            raise
        raise LogError(
            f"this format is read with {module}, which is not installed",
            where=where,
            do=f"pip install 'brake-cal[{extra}]'",
        ) from cause
