"""Folder of the sample logs, in a checkout and in an installed package."""

from pathlib import Path

from calib.base.errors import InputError


def sample_logs() -> Path:
    """Return the folder of the sample logs. Raises InputError if they are not installed.

    >>> import calib
    >>> sorted(file.name for file in (calib.sample_logs() / "simulation_study").glob("*.parquet"))
    ['ramp_noisy.parquet', 'stop_noisy.parquet']
    """
    room = Path(__file__).parent
    for place in (room / "sample_logs", room.parents[1] / "sample_logs"):
        if place.is_dir():
            return place
    raise InputError(
        "the sample logs are not installed",
        where=room,
        expected="sample_logs/ in the package or beside it",
        do="install brake-cal from its wheel or its checkout",
    )
