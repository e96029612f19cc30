"""The C of a version in one call: for an ECU, or in an FMU."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from calib.base.errors import ExchangeError
from calib.base.plain import counted
from calib.ecu.bundle import names, require_prefix, write_bundle
from calib.ecu.car_source import PREFIX, axes_of, cell, code_grids, require_time
from calib.ecu.fmu import Content, Version, write_fmu
from calib.exports.export import require_handed_out
from calib.store.evidence import UNPROVED, Quality
from calib.store.version import Stored
from calib.table.exported import Precision

FOLDER = "ecu"
"""The format that is a folder; the others are one file each."""


@dataclass(frozen=True)
class WrittenCode:
    """The C of a version, written to ``out`` in a format of `calib.exports.export.CODES`."""

    stored: Stored
    out: Path
    form: str
    how: Precision
    sample_time: float
    files: tuple[str, ...]
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"{self.out}: {self.stored.id} as {self.form}, {counted(len(self.files), 'file')}"

    def to_dict(self) -> dict[str, Any]:
        """The JSON document of an export of code."""
        return {
            "table": self.stored.id,
            "digest": self.stored.digest,
            "version": self.stored.version,
            "format": self.form,
            "out": self.out,
            "files": self.files,
            "float": self.how.floating,
            "cell": cell(self.how),
            "sample_time": self.sample_time,
        }


def files_of(prefix: str | None) -> list[str]:
    """Return the names in the folder of an ECU. Raises ExchangeError for a prefix that is none."""
    first = PREFIX if prefix is None else prefix
    require_prefix(first)
    return names(first)


def write_code(
    stored: Stored,
    out: Path,
    form: str,
    how: Precision,
    sample_time: float = 0.01,
    prefix: str | None = None,
    *,
    elf: Path | None = None,
    quality: Quality = UNPROVED,
    without_effects: Sequence[str] = (),
    unreleased: bool = False,
) -> WrittenCode:
    """Write the estimator, or the simulated car, with the numbers of a version.

    Parameters
    ----------
    form : ``ecu``, a folder; ``fmu2`` or ``fmu3``, the same in an FMU; ``car-fmu2`` or
        ``car-fmu3``, an FMU of the car whose sensors that one reads.
    sample_time : from call to call [s].
    prefix, elf, quality : of a folder alone, see `calib.ecu.bundle.write_bundle`.
    without_effects, unreleased : what may be handed out, see `require_handed_out`.

    Raises ExchangeError for what no code can have, StoreError for a version that is not handed out,
    OSError.
    """
    require_handed_out(stored, without_effects, unreleased=unreleased)
    require_time(sample_time)
    car = stored.table.vehicle
    left = replace(car, effects=car.effects.without(*without_effects))
    stored = replace(stored, table=replace(stored.table, vehicle=left))
    if form != FOLDER:
        if elf or prefix is not None or quality is not UNPROVED:
            raise ExchangeError("an FMU has no --elf, --prefix, --validation")
        version: Version = 2 if form.endswith("2") else 3
        content: Content = "car" if form.startswith("car") else "estimator"
        write_fmu(stored, out, how, sample_time, version, content)
        return WrittenCode(stored, out, form, how, sample_time, (out.name,))
    first = PREFIX if prefix is None else prefix
    files = write_bundle(stored, out, how, sample_time, first, quality=quality, elf=elf)
    axes = axes_of(code_grids(stored.table, first, how))
    notes = tuple(f"{axis.label}: {axis.placed}" for axis in axes if axis.reduced)
    made = tuple(path.name for path in files)
    return WrittenCode(stored, out, form, how, sample_time, made, notes)
