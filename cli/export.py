"""`brake-cal tables export`: a table as the file of a calibration tool, an ECU, another program."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import calib
from cli.completion import names_of
from cli.console import emit, emit_json, say
from cli.options import Force, Json, Store, TableVersion, example, grouped, out_file
from cli.outputs import refuse_folder, refuse_foreign, refuse_overwriting, writing
from cli.project import STORE
from cli.signed import Signing, check_signed

if TYPE_CHECKING:
    from calib.exports.dataset import Dataset
    from calib.exports.export import Exported
    from calib.store.evidence import Quality
    from calib.store.version import Stored

EPILOG = example(
    "brake-cal tables export sedan-2up --out sedan.dcm",
    "brake-cal tables export sedan-2up --format c-header --fixed-point 16 --points 16 --out s.h",
    "brake-cal tables export sedan-2up --out sedan.a2l",
)


@grouped
def export_table(
    table: TableVersion,
    *,
    form: Annotated[
        str | None,
        typer.Option(
            "--format",
            metavar="F",
            help="json, csv, parquet, dcm, cdfx, a2l, c-header or inca-csv; else by the ending of "
            "--out.",
            autocompletion=names_of("calib.exports.export", "ENDINGS"),
        ),
    ] = None,
    out: Annotated[Path, out_file("File to write.")],
    points: Annotated[
        int | None,
        typer.Option(metavar="N", help="Breakpoints on each axis, least error; else all rows."),
    ] = None,
    bits: Annotated[
        int | None,
        typer.Option("--fixed-point", metavar="BITS", help="8, 16 or 32; for c-header, a2l."),
    ] = None,
    elf: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Linked program (ELF), for addresses of an a2l."),
    ] = None,
    validation: Annotated[
        Path | None,
        typer.Option(metavar="SUMMARY", help="summary.json of `validate --out`, for the state."),
    ] = None,
    unreleased: Annotated[
        bool,
        typer.Option(
            "--unreleased", help="Also a version that is not released; the file then says so."
        ),
    ] = False,
    force: Force = False,
    signing: Signing,
    store: Store = STORE,
    json: Json = False,
) -> None:
    """Write a table for a calibration tool or an ECU.

    Only a released one, unless --unreleased is given. A bare name is its newest released version.
    Every file states the table's id, version, digest and state, the checksum of its numbers, and
    which value holds beyond the ends of an axis.
    """
    form = _known(form, out)
    _check_usage(form, out, bits, elf)
    public = signing.public()
    from calib.base.errors import ExchangeError

    opened = calib.Store(store)
    stored = opened.load(table) if unreleased else opened.released(table)
    check_signed(table, stored, public)
    digest = stored.digest.encode()
    refuse_foreign(out, lambda data: digest in data, f"an export of {stored.id}", force)
    quality = _quality(validation, stored)
    try:
        with writing(out):
            written = calib.export(
                stored, out, form,
                points=points, bits=bits, elf=elf, quality=quality, unreleased=unreleased,
            )  # fmt: skip
    except ExchangeError as error:
        option = "--points" if bits is None else "--points, --fixed-point"
        raise typer.BadParameter(str(error), param_hint=option) from None
    _report(written, bits, json)


def _known(form: str | None, out: Path) -> str:
    """The format that was named, or that of the ending of the file."""
    from calib.base.errors import ExchangeError
    from calib.exports.export import format_named, format_of

    try:
        return format_of(out.name) if form is None else format_named(form)
    except ExchangeError as error:
        hint = "--out" if form is None else "--format"
        raise typer.BadParameter(str(error), param_hint=hint) from None


def _check_usage(form: str, out: Path, bits: int | None, elf: Path | None) -> None:
    from calib.exports.export import ADDRESSED, FIXED_POINT

    if bits is not None and form not in FIXED_POINT:
        raise typer.BadParameter(f"only with {', '.join(FIXED_POINT)}", param_hint="--fixed-point")
    if elf is not None and form not in ADDRESSED:
        raise typer.BadParameter(f"only with {', '.join(ADDRESSED)}", param_hint="--elf")
    if elf is not None and elf.suffix.lower() == ".map":
        raise typer.BadParameter(
            "a linker's map is no longer read: give the linked program (ELF)", param_hint="--elf"
        )
    refuse_folder(out)
    refuse_overwriting([out], [], [elf])


def _quality(path: Path | None, stored: "Stored") -> "Quality":
    from calib.store.evidence import UNPROVED, read_quality

    return UNPROVED if path is None else read_quality(path, stored)


def _report(written: "Exported", bits: int | None, json: bool) -> None:
    data = written.data
    rounding = _rounding(data, bits)
    if json:
        emit_json(
            {
                "schema": 1,
                **data.facts(),
                "version": data.version,
                "format": written.form,
                "out": written.path,
                "bytes": len(written.content),
                "sha256": written.sha256,
                "axes": [_axis(data, a.label) for a in data.axes],
                "remarks": list(written.remarks),
                "fixed_point": {"bits": bits, "objects": rounding} if rounding else None,
            }
        )
        return
    from calib.exports.dataset import placed

    for axis in data.axes:
        say(f"{axis.label}: {placed(axis)}")
    for row in rounding:
        if row["read_error"] is not None:
            say(f"{row['label']}: rounding {row['error']:.3g}, as read {row['read_error']:.3g}")
    for remark in written.remarks:
        say(remark)
    emit(repr(written))


def _axis(data: "Dataset", label: str) -> dict[str, object]:
    axis = data.axis(label)
    return {
        "label": label,
        "points": len(axis.values),
        "rows": axis.rows,
        "curves": [c.label for c in data.over(axis)],
        "worst": axis.misfit.worst,
        "worst_at": axis.misfit.at,
        "rms": axis.misfit.rms,
    }


def _rounding(data: "Dataset", bits: int | None) -> list[dict[str, object]]:
    from calib.exports.fixed_point import roundings

    return [] if bits is None else [vars(r) for r in roundings(data, bits)]
