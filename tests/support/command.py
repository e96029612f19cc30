"""The command line in this process, as the shell would run it."""

from pathlib import Path

import pytest

from calib.fitting import fit as fitting
from calib.line.station import station
from cli.main import main
from tests.support.shared import shared

fit_once = shared(fitting.fit)
"""`fit`, where its table is not what a test is about: made once of the same logs."""


def typed(*words: object, folder: Path | None = None) -> int:
    """Exit code of ``brake-cal`` with some words, in a folder.

    Tables are those of `fit_once`. The panels of pages are blank: drawing takes longer than all
    else, and tests/show does it.
    """
    with pytest.MonkeyPatch.context() as patch:
        if folder is not None:
            patch.chdir(folder)
        for module in (fitting, station):
            patch.setattr(module, "fit", fit_once)
        patch.setattr("calib.show.html._panel", lambda sheet, name: "data:image/svg+xml,")
        patch.setattr("sys.argv", ["brake-cal", *map(str, words)])
        with pytest.raises(SystemExit) as ended:
            main()
    code = ended.value.code
    return code if isinstance(code, int) else int(bool(code))


def files_under(folder: Path) -> dict[Path, bytes]:
    """The bytes of all files in a folder by their paths."""
    return {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if p.is_file()}
