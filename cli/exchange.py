"""`brake-cal tables export`, `compare` and `merge`: tables leave a store and come back."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from cli.command import DAMAGED, Answer, command
from cli.console import at_option, misuse, say
from cli.options import Table, Tables, argument, option, table_versions
from cli.outputs import EITHER, check_file, check_folder, refuse_foreign, writing
from cli.sign import Signed

if TYPE_CHECKING:
    from calib.ecu.fmu import Content, Version
    from calib.store.version import Stored
    from calib.table.exported import Precision


@command(
    "brake-cal tables export sedan-2up --out sedan.dcm",
    "brake-cal tables export sedan-2up --format c-header --fixed-point 16 --points 16 --out s.h",
    "brake-cal tables export sedan-2up --format ecu --float --sample-time 0.005 --out bte",
)
def export(
    table: Table,
    *,
    form: str | None = option(
        "Format, by its name on the page `tables` of the manual; else by the ending of --out.",
        "F",
        "--format",
    ),
    out: Path = option("File to write, or the folder of the code.", "FILE", writes=EITHER),
    points: int | None = option("Breakpoints on each axis, least error; else all rows.", "N"),
    bits: int | None = option(
        "8, 16 or 32; for c-header, a2l, ecu and FMUs.", "BITS", "--fixed-point"
    ),
    single: bool = option("Single precision; for c-header, a2l, ecu and FMUs.", None, "--float"),
    sample_time: float | None = option("Time from call to call [s], 0.01; for ecu and FMUs.", "S"),
    prefix: str | None = option("Of all labels; the table's name, of code bte.", "NAME"),
    elf: Path | None = option("Linked program (ELF), for addresses of an A2L.", "FILE"),
    validation: Path | None = option("summary.json of `validate --out`, for the state.", "SUMMARY"),
    without_effect: list[str] = option("Known effect that no ECU senses; repeatable.", "NAME"),
    unreleased: bool = option("Also a version that is not released; the file then says so."),
    signed: Signed,
    store: Tables,
) -> Answer:
    """Write a table for a calibration tool or an ECU.

    Only a released one, unless --unreleased is given; a car with a known effect that no ECU senses,
    such as discs that fade, only --without-effect. Every file states the table's id, digest and
    state, the checksum of its numbers, and which value holds beyond the ends of an axis.
    """
    from dataclasses import replace

    from calib.base.errors import ExchangeError
    from calib.exports.export import CODES, require_handed_out
    from calib.exports.export import export as write
    from calib.store.evidence import UNPROVED, read_quality

    stored = store.load(table) if unreleased else store.released(table)
    signed.check(table, stored)
    quality = read_quality(validation, stored) if validation else UNPROVED
    if form and form.lower() in CODES:
        from calib.ecu.car_source import require_time
        from calib.table.exported import Precision

        require_handed_out(stored, without_effect, unreleased=unreleased)
        left = stored.table.vehicle.effects.without(*without_effect)
        car = replace(stored.table.vehicle, effects=left)
        stored = replace(stored, table=replace(stored.table, vehicle=car))
        with at_option("--points, --fixed-point, --float", ExchangeError):
            how = Precision(points, bits, single)
        step = 0.01 if sample_time is None else sample_time
        with at_option("--sample-time", ExchangeError):
            require_time(step)
        if form.lower() == "ecu":
            return _code(stored, out, how, step, prefix, quality=quality, elf=elf)
        if elf or prefix is not None or validation:
            raise misuse("not for an FMU", "--elf, --prefix, --validation")
        return _fmu(stored, out, how, step, form.lower())
    if sample_time is not None:
        raise misuse(f"for --format {', '.join(CODES)} alone", "--sample-time")
    check_file(out)
    digest = stored.digest.encode()
    refuse_foreign(out, lambda data: digest in data)
    asked: dict[str, Any] = {"points": points, "bits": bits, "single": single, "elf": elf}
    asked |= {"prefix": prefix, "unreleased": unreleased, "without_effects": without_effect}
    options = "--format, --points, --fixed-point, --float, --elf, --without-effect"
    with at_option(options, ExchangeError), writing(out):
        written = write(stored, out, form, quality=quality, **asked)
    for axis in written.data.axes:
        if axis.reduced:
            say(f"{axis.label}: {axis.placed}")
    for row in written.rounded:
        if row["read_error"] is not None:
            say(f"{row['label']}: rounding {row['error']:.3g}, as read {row['read_error']:.3g}")
    for remark in written.remarks:
        say(remark)
    return Answer(written.to_dict(), repr(written))


def _code(
    stored: "Stored", out: Path, how: "Precision", step: float, prefix: str | None, **more: Any
) -> Answer:
    """Write the estimator as C, with the numbers of a table, to a folder."""
    from calib.base.errors import ExchangeError
    from calib.ecu.bundle import OURS, names, require_prefix, write_bundle
    from calib.ecu.car_source import PREFIX, axes_of, code_grids

    first = PREFIX if prefix is None else prefix
    with at_option("--prefix", ExchangeError):
        require_prefix(first)
    check_folder(out, names(first))
    refuse_foreign(out / "README.md", lambda data: stored.digest.encode() in data)
    for name in names(first):
        refuse_foreign(out / name, lambda data: OURS in data)
    with at_option("--points, --fixed-point, --float, --elf", ExchangeError), writing(out):
        files = write_bundle(stored, out, how, step, first, **more)
    for axis in axes_of(code_grids(stored.table, first, how)):
        if axis.reduced:
            say(f"{axis.label}: {axis.placed}")
    return _coded(stored, out, "ecu", how, step, files)


def _fmu(stored: "Stored", out: Path, how: "Precision", step: float, form: str) -> Answer:
    """Write the same code, or the simulated car, as an FMU."""
    from calib.ecu.fmu import write_fmu

    check_file(out)
    refuse_foreign(out, lambda data: stored.digest.encode() in data)
    version: Version = 2 if form.endswith("2") else 3
    content: Content = "car" if form.startswith("car") else "estimator"
    with writing(out):
        write_fmu(stored, out, how, step, version, content)
    return _coded(stored, out, form, how, step, [out])


def _coded(
    stored: "Stored", out: Path, form: str, how: "Precision", step: float, files: list[Path]
) -> Answer:
    from calib.base.plain import counted
    from calib.ecu.car_source import cell

    document = {
        "table": stored.id,
        "digest": stored.digest,
        "version": stored.version,
        "format": form,
        "out": out,
        "files": [path.name for path in files],
        "float": how.floating,
        "cell": cell(how),
        "sample_time": step,
    }
    return Answer(document, f"{out}: {stored.id} as {form}, {counted(len(files), 'file')}")


@command("brake-cal tables compare sedan.dcm")
def compare(file: Path = argument("Exported DCM or CDF file.", "FILE"), *, store: Tables) -> Answer:
    """Compare a DCM or CDF file with the table that it names.

    Exit code 3 if it is cut off, damaged or names no table, 4 if it does not agree with the table.
    Another tool may have saved it: labels are compared, and numbers that were rounded agree.
    """
    from calib.exports.compare import difference, parent
    from calib.exports.read import read_back
    from calib.show.differences import returned, returned_document

    found = read_back(file)
    stored = parent(found, store)
    told = difference(found, stored)
    document = returned_document(found, stored, told)
    return Answer(document, returned(found, stored, told), DAMAGED * bool(told.wrong))


def _name(name: str) -> str:
    from calib.store.folders import NAME

    if not NAME.fullmatch(name) or ".." in name:
        raise misuse(f"{name!r} cannot name a table; letters, digits and . _ - only")
    return name


@command("brake-cal tables merge car@1 car@2 car@3 --name golden")
def merge(
    tables: list[str] = argument(
        "name@version or path, one of each car", "CAR@1 CAR@2 ...", autocompletion=table_versions
    ),
    *,
    name: str = option("Name of the mean table.", "NAME", make=_name),
    store: Tables,
) -> Answer:
    """Store the mean of several cars as a golden table.

    With the spread between them; its bands are those of one more car of the model.
    """
    from calib.show.store import merged, merged_document
    from calib.store.merge import merge as mean_of

    stored = store.save(mean_of([store.load(table) for table in tables], name))
    return Answer(merged_document(stored), merged(stored))
