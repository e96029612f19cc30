"""Write a table as the file of a calibration tool, of an ECU or of another program."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from calib.base.digest import sha256
from calib.base.errors import ExchangeError, StoreError
from calib.base.toml import did_you_mean
from calib.base.write import write_whole
from calib.exports.addresses import find_addresses
from calib.exports.build import build
from calib.exports.dataset import Dataset
from calib.exports.write import FORMATS
from calib.store.version import Stored, as_version
from calib.table.table import Table

ENDINGS = {name: form.ending for name, form in FORMATS.items()}  # of files, by format
CODES = ("ecu", "fmu2", "fmu3", "car-fmu2", "car-fmu3")
"""Formats of `calib.ecu`: the estimator for an ECU, the estimator as an FMU of FMI 2.0 or 3.0, and
an FMU of the simulated car, whose sensors the estimator reads."""


def _form_of(path: Path, written: str | None) -> str:
    """Return the format that is named (in upper or lower case), else that of the file's ending."""
    endings = {f".{ending}": name for name, ending in ENDINGS.items()}
    form = endings.get(path.suffix.lower(), "") if written is None else written.lower()
    if form in FORMATS:
        return form
    if written is None:
        expected = f"one of {', '.join(endings)}"
        raise ExchangeError("its ending names no format", where=path, expected=expected)
    formats = [*ENDINGS, *CODES]
    do = did_you_mean(form, formats)
    raise ExchangeError(f"unknown format {written!r}", expected=", ".join(formats), do=do)


@dataclass(frozen=True)
class Exported:
    """A written file: its ``content`` is ``data`` in the format ``form``."""

    path: Path
    form: str
    data: Dataset
    content: bytes = field(repr=False)

    def __repr__(self) -> str:
        return f"{self.path}: {self.data.stored.id} as {self.form}, {len(self.content)} bytes"

    @property
    def remarks(self) -> tuple[str, ...]:
        """Assumptions of the file about the ECU's memory, in words."""
        return self.data.addresses.remarks if FORMATS[self.form].addressed else ()

    @property
    def notes(self) -> tuple[str, ...]:
        """Axes with fewer points than the table has rows, and the ``remarks``, in words."""
        reduced = (f"{axis.label}: {axis.placed}" for axis in self.data.axes if axis.reduced)
        return (*reduced, *self.remarks)

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON document of an export."""
        data = self.data
        axes = [
            {"label": x.label, "points": len(x.values), "rows": x.rows, **vars(x.misfit)}
            for x in data.axes
        ]
        rounded = [
            {"label": x.label, "step": x.fixed.step, "error": x.fixed.error}
            for x in data.objects
            if x.fixed is not None
        ]
        return {
            **data.facts(),
            "version": data.stored.version,
            "format": self.form,
            "out": self.path,
            "bytes": len(self.content),
            "sha256": sha256(self.content),
            "axes": axes,
            "remarks": list(self.remarks),
            "fixed_point": {"bits": data.bits, "objects": rounded} if data.bits else None,
        }


def require_handed_out(
    stored: Stored, without_effects: Sequence[str] = (), *, unreleased: bool = False
) -> None:
    """Raise as `export` for a version that is not released, or has effects that no ECU senses."""
    if not (stored.state.released or unreleased):
        raise StoreError(
            f"is {stored.state.description}",
            where=stored.id,
            expected="a released version",
            do=f"release it with `brake-cal tables release {stored.id} --reason ... --evidence "
            "...`, or hand it out as it is with --unreleased: the file then says so",
        )
    by_effect = stored.table.not_sensed  # the reason why no ECU senses it
    unknown = [name for name in without_effects if name not in by_effect]
    if unknown:
        flaw = f"{unknown[0]} is no known effect of {stored.id} that an ECU cannot sense"
        raise ExchangeError(flaw, expected=", ".join(by_effect) or "none")
    not_sensed = {name: why for name, why in by_effect.items() if name not in without_effects}
    if not_sensed:
        raise StoreError(
            "the ECU cannot take out "
            + ", ".join(f"{name}: it does not know {why}" for name, why in not_sensed.items()),
            where=stored.id,
            expected="effects that pressure, deceleration and wheel speeds show",
            do="see what it costs in ecu_* of `brake-cal validate`, and hand it out with "
            + " ".join(f"--without-effect {name}" for name in not_sensed),
        )


def export(
    table: Table | Stored,
    path: Path | str,
    form: str | None = None,
    *,
    points: int | None = None,
    bits: int | None = None,
    single: bool = False,
    prefix: str | None = None,
    elf: Path | str | None = None,
    unreleased: bool = False,
    without_effects: Sequence[str] = (),
) -> Exported:
    """Write a table to the file ``path``; an existing file is replaced.

    Parameters
    ----------
    table : a version of `Store.save` or `Store.load`; or a fitted table, which is version 0.
    form : one of `ENDINGS`; else by the ending of ``path``.
    points : breakpoints on each axis, at the rows with the least error; all rows if not given.
    bits : of the fixed point, 8, 16 or 32; for c-header and a2l.
    single : in single precision; for c-header and a2l.
    prefix : first part of every label; the table's name if not given.
    elf : linked program with the C header (ELF), for the addresses of an a2l.
    unreleased : also write a version that is not released; the file then says so.
    without_effects : known effects that an ECU cannot sense and may ignore; its answers then err.

    Raises StoreError for a version that is not released, or has such effects that are not named;
    ExchangeError for a name that is no such effect, an unknown format, or a format that cannot hold
    the numbers; ProgramError where ``elf`` does not hold the table; OSError.

    >>> import tempfile
    >>> from pathlib import Path
    >>> import calib
    >>> logs = calib.sample_logs() / "simulation_study"
    >>> car = calib.read_vehicle(logs / "vehicle.toml")
    >>> table = calib.fit(car, [calib.read_log(logs / "ramp_noisy.parquet")])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     dcm = Path(folder) / "car.dcm"
    ...     written = calib.export(table, dcm, points=16, unreleased=True)
    >>> written.form, written.data.stored.id, [len(axis.values) for axis in written.data.axes[:2]]
    ('dcm', 'sedan-sim@0', [16, 16])
    """
    stored = as_version(table)
    require_handed_out(stored, without_effects, unreleased=unreleased)
    path = Path(path)
    form = _form_of(path, form)
    for is_given, feature, name in (
        (bits is not None, "fixed", "fixed point"),
        (single, "fixed", "single precision"),  # the same formats have both
        (elf is not None, "addressed", "addresses"),
    ):
        if is_given and not getattr(FORMATS[form], feature):
            able = [other for other, x in FORMATS.items() if getattr(x, feature)]
            raise ExchangeError(f"{form} has no {name}", expected=", ".join(able))
    most = FORMATS[form].most_axes
    data = build(stored, points, bits, single=single, most_axes=most, first=prefix)
    if elf is not None:
        data = replace(data, addresses=find_addresses(Path(elf), data))
    content = FORMATS[form].write(data)
    write_whole(path, content)
    return Exported(path, form, data, content)
