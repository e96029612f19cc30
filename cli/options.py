"""Options that several commands share, and the example at the end of a command's help."""

from pathlib import Path
from typing import Annotated

import typer

Store = Annotated[Path, typer.Option("--store", metavar="DIR", help="Directory of the tables.")]
Map = Annotated[Path | None, typer.Option("--map", metavar="M.toml", help="Channel map, and DBC.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document on stdout.")]
KnownModel = Annotated[
    Path | None,
    typer.Option(
        "--model", metavar="M.toml", help="Model of `diagnose`, whose effects are known beforehand."
    ),
]

STORE = Path("tables")
"""Default of `Store`."""


def example(*lines: str) -> str:
    """Epilog of a command's help: ``lines`` as they can be typed in the folder of the demo."""
    return "\n".join(("\b", "Example:", *(f"  {line}" for line in lines)))
