"""Logs of bus frames that are packed with gzip, such as ``run.blf.gz``."""

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from calib.errors import LogError
from calib.files.bounded import LOG, bytes_of
from calib.logs.bus.databases import Databases
from calib.logs.recording import Recording
from calib.logs.text.compressed import gunzip

Open = Callable[[Path, Databases], Recording]


def packed(open_log: Open) -> Open:
    """A function that opens the packed form of what ``open_log`` opens.

    The log is unpacked into a temporary folder, which is deleted when it is open: ``open_log`` must
    read all frames. Messages name the packed file. Raises LogError also for a gzip file that is cut
    off or damaged.
    """

    def opened(path: Path, dbc: Databases) -> Recording:
        content = gunzip(bytes_of(path, LOG, LogError, "a packed log"), str(path))
        with TemporaryDirectory() as folder:
            plain = Path(folder) / "log"
            plain.write_bytes(content)
            try:
                return open_log(plain, dbc)
            except LogError as cause:
                where = str(cause.where).replace(str(plain), str(path))
                raise LogError(
                    cause.what, where=where, expected=cause.expected, do=cause.do
                ) from cause

    return opened
