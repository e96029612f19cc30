"""The logs that a table was fitted on, found again by the SHA-256 of their bytes."""

from collections.abc import Sequence
from pathlib import Path

from calib.base.digest import file_digest
from calib.base.errors import LogError
from calib.store.version import Stored

_DRIVEN = ("ramp", "coast")


def logs_again(stored: Stored, places: Sequence[Path]) -> list[Path]:
    """The file of each log of a fit, in its order, among the files and folders ``places``.

    Raises LogError with the name and digest of each that is not there.
    """
    within = [sorted(at.rglob("*")) if at.is_dir() else [at] for at in places]
    found = {file_digest(path): path for paths in within for path in paths if path.is_file()}
    wanted = [log for log in stored.table.provenance.logs if log.role in _DRIVEN]
    missing = [log for log in wanted if log.digest not in found]
    if missing or not wanted:
        raise LogError(
            f"{len(missing)} of its {len(wanted)} logs are not there",
            where=stored.id,
            expected=f"files with their bytes below {', '.join(map(str, places))}",
            lines=tuple(f"{log.name}, SHA-256 {log.digest}" for log in missing),
        )
    return [found[log.digest] for log in wanted]
