"""Import of `cryptography`, which only signing needs."""

import importlib
from typing import Any

from calib.errors import KeyFileError


def need(module: str) -> Any:
    """Import ``module`` of cryptography.

    Raises KeyFileError that names the extra if cryptography is not installed.
    """
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as cause:
        if cause.name is None or cause.name.split(".")[0] != "cryptography":
            raise
        raise KeyFileError(
            "keys are used with cryptography, which is not installed",
            do="pip install 'brake-cal[sign]'",
        ) from cause


def ed25519() -> Any:
    """The module of Ed25519 keys."""
    return need("cryptography.hazmat.primitives.asymmetric.ed25519")
