"""The page `validation` names every code that the program knows."""

import re
from pathlib import Path

import calib
from calib.help.page import FOLDER

CODE = re.compile(r'PlausibilityWarning\(\s*f?"([a-z_{}]+)"')
SOURCES = Path(calib.__file__).parent.rglob("*.py")


def codes() -> set[str]:
    """Codes as they stand in the sources; an axle or side in braces is the front one."""
    found = {code for source in SOURCES for code in CODE.findall(source.read_text())}
    return {re.sub(r"\{\w+\}", "f", code) for code in found}


def test_every_code_is_on_the_page():
    page = (FOLDER / "validation.md").read_text()
    known = codes()
    assert len(known) > 30
    assert [code for code in sorted(known) if f"`{code}`" not in page] == []
