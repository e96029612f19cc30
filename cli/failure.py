"""Errors as JSON, see `calib.base.record`."""

from typing import Any

from calib.base.errors import BrakeCalError

USAGE = "usage"
"""Kind of an error in the command line itself."""


def document_of(error: BrakeCalError) -> dict[str, object]:
    """The document of an error of the library."""
    return {"schema": 1, "error": error.to_dict()}


def usage_document(error: Any) -> dict[str, object]:
    """The document of a usage error of typer."""
    command = error.ctx.command_path if error.ctx else "brake-cal"
    hint = getattr(error, "param_hint", None) or ""
    return {
        "schema": 1,
        "error": {
            "kind": USAGE,
            "message": error.format_message(),
            "exit_code": error.exit_code,
            "what": error.message,
            "where": hint if isinstance(hint, str) else " ".join(hint),
            "expected": "",
            "do": f"see `{command} --help`",
            "lines": (),
        },
    }
