"""Tyre property files as text: keys of the Magic Formula with the comments that tools write."""

from pathlib import Path

KEYS = {
    "FNOMIN": 4300.0,
    "PCX1": 1.65,
    "PDX1": 0.9,
    "PDX2": 0.0,
    "PEX1": 0.0,
    "PKX1": 25.0,
    "PKX2": 0.0,
    "PKX3": 0.0,
}
"""A tyre of the stiffness 25 and the peak 0.9 that does not mind its load."""


def written(path: Path, force: str = "newton", **changed: float | str | None) -> Path:
    """A file with `KEYS` and those that are ``changed``; None leaves a key out."""
    keys = {name: value for name, value in {**KEYS, **changed}.items() if value is not None}
    lines = [
        "$------------------------------------------------------units",
        "[UNITS]",
        "LENGTH                   = 'meter'",
        f"FORCE                    ='{force}'",
        "[MODEL]",
        "PROPERTY_FILE_FORMAT     ='PAC2002'",
        "!PKX1                    = 99   a line that is a comment",
        "[SHAPE]",
        "{radial width}",
        " 1.0    0.0",
        "[ALL_COEFFICIENTS]",
        *(f"{name:24} = {value}    $what it is = 7" for name, value in keys.items()),
    ]
    path.write_text("\n".join([*lines, ""]), encoding="latin-1")
    return path
