"""The manual names every code of a warning."""

from calib.base.warning import UNITS
from calib.help.page import FOLDER

PAGES = "".join((FOLDER / f"{name}.md").read_text() for name in ("troubleshooting", "vehicle_file"))
"""Codes of logs and results, and of vehicle files. `_f` stands for both axles, a key for itself."""


def test_every_code_is_in_the_manual():
    assert len(UNITS) > 50
    for code in UNITS:
        key = code.removesuffix("_f").removesuffix("_r")
        assert any(f"`{name}`" in PAGES for name in (code, f"{key}_f", key)), code
