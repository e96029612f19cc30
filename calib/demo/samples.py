"""Where the sample logs are, in a checkout and in an installed package alike."""

from pathlib import Path

from calib.errors import InputError


def sample_logs() -> Path:
    """Directory of the sample logs. Raises InputError when the program was installed without them.

    A wheel carries them inside the package; in a checkout they lie beside it.
    """
    package = Path(__file__).parents[1]
    for place in (package / "sample_logs", package.parent / "sample_logs"):
        if place.is_dir():
            return place
    raise InputError(
        "the sample logs are not installed",
        where=package,
        expected="sample_logs/ in the package or beside it",
        do="install brake-cal from its wheel or its checkout",
    )
