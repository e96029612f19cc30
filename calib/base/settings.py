"""Settings of a project: what its file says, and where the file is.

brake-cal.toml      in the working folder or one above it; the first one found counts
"""

from dataclasses import dataclass
from pathlib import Path

NAME = "brake-cal.toml"
STORE = Path("tables")
"""The store where neither the command line nor the settings file names one."""
VARIABLE = "BRAKE_CAL_SETTINGS"
"""Environment variable: the path of a settings file; empty for none."""


@dataclass(frozen=True)
class Settings:
    """What a settings file says; None for what it does not say. Paths lead from where we are.

    ``store``: folder of tables. ``vehicle``, ``map``, ``limits``: files. ``station``: its name.
    ``golden``: name@version or path of a table. ``export``: formats. ``public_key``: path, or the
    key itself as text. ``by``: name of the person.
    """

    store: Path | None = None
    vehicle: Path | None = None
    map: Path | None = None
    limits: Path | None = None
    station: str | None = None
    golden: str | None = None
    export: tuple[str, ...] | None = None
    public_key: Path | str | None = None
    require_signed: bool | None = None
    by: str | None = None
