"""`brake-cal tables export`, `compare` and `merge`: hand out tables, compare and average them."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cli.command import DAMAGED, Answer, command
from cli.console import at_option, say, usage_error
from cli.options import Table, Tables, argument, option
from cli.outputs import EITHER, check_file, check_folder, refuse_foreign, writing
from cli.sign import Signed

if TYPE_CHECKING:
    from calib.store.version import Stored
    from calib.table.exported import Precision

_BITS = "Write integers of 8, 16 or 32 bits; for c-header, a2l, ecu and FMUs."
_SINGLE = "Write single precision; for c-header, a2l, ecu and FMUs."
_DOUBLE = "Write double precision; the code for an ECU is else in single precision."


@dataclass(frozen=True)
class Shape:
    """Breakpoints and precision of an exported table."""

    points: Annotated[int | None, option("Breakpoints on each axis, else all rows.", "N")]
    bits: Annotated[int | None, option(_BITS, "BITS", "--fixed-point")]
    single: Annotated[bool, option(_SINGLE, None, "--float")]
    double: Annotated[bool, option(_DOUBLE)]

    def precision(self, *, for_ecu: bool) -> "Precision | None":
        """Return the typed precision; if none was typed, None, or single precision for an ECU.

        ``--double`` only replaces that default.
        """
        from calib.base.errors import ExchangeError
        from calib.table.exported import Precision

        if self.double and (self.single or self.bits):
            raise usage_error("not beside --float or --fixed-point", "--double")
        is_typed = self.points is not None or self.bits is not None or self.single
        if not (is_typed or for_ecu):
            return None
        single = self.single or (for_ecu and not self.double and self.bits is None)
        with at_option("--points, --fixed-point, --float", ExchangeError):
            return Precision(self.points, self.bits, single, for_ecu)


@command(
    "brake-cal tables export sedan-2up --out sedan.dcm",
    "brake-cal tables export sedan-2up --format ecu --sample-time 0.005 --out bte",
)
def export(
    table: Table,
    *,
    form: str | None = option("Format, see `manual tables`; else that of --out.", "F", "--format"),
    out: Path = option("File to write, or the folder of the code.", "FILE", writes=EITHER),
    shape: Shape,
    sample_time: float | None = option("Time of a step [s], else that of the logs.", "S"),
    prefix: str | None = option("First part of all labels, else the name of the table.", "NAME"),
    elf: Path | None = option("Linked program (ELF), for addresses of an A2L.", "FILE"),
    compiled: bool = option("Put a binary for this machine into an FMU; needs FMPy and cmake."),
    without_effect: list[str] = option("Effect that the ECU lacks; repeatable.", "NAME"),
    unreleased: bool = option("Export a version that is not released; the file says so."),
    signed: Signed,
    store: Tables,
) -> Answer:
    """Write a table for a calibration tool or an ECU.

    The table must be released, unless --unreleased is given. A car with a known effect that no ECU
    senses, such as discs that fade, needs --without-effect. Every file has id, digest and state of
    the table, the checksum of its numbers, and which value holds beyond the ends of an axis.
    """
    from calib.base.errors import ExchangeError
    from calib.ecu.code import FOLDER, write_code
    from calib.exports.export import CODES
    from calib.exports.export import export as write
    from calib.table.exported import Precision

    stored = store.load(table) if unreleased else store.released(table)
    signed.check(table, stored)
    kind = (form or "").lower()
    is_code, is_folder = kind in CODES, kind == FOLDER  # an FMU is code in one file
    _check_out(out, stored, prefix, is_folder=is_folder)
    choices: Any = {"elf": elf, "unreleased": unreleased, "without_effects": without_effect}
    if not is_code and (sample_time is not None or compiled):
        raise usage_error(f"only with --format {', '.join(CODES)}", "--sample-time, --compiled")
    written: Any
    with at_option(None, ExchangeError), writing(out):
        if is_code:
            precision = shape.precision(for_ecu=is_folder) or Precision()
            of_logs = stored.table.provenance.sample_time
            step = of_logs if sample_time is None else sample_time
            if step is None:
                flaw = "missing; the logs of the table have no common time of a step"
                raise usage_error(flaw, "--sample-time")
            choices["compiled"] = compiled
            written = write_code(stored, out, kind, precision, step, prefix, **choices)
        else:
            choices |= {"points": shape.points, "bits": shape.bits, "single": shape.single}
            written = write(stored, out, form, prefix=prefix, **choices)
    for note in written.notes:
        say(note)
    return Answer(written.to_dict(), repr(written))


def _check_out(out: Path, stored: "Stored", prefix: str | None, *, is_folder: bool) -> None:
    """Refuse a place that holds anything but an export of the version ``stored``."""
    from calib.ecu.code import OURS, files_of

    digest = stored.digest.encode()
    if not is_folder:
        check_file(out)
        refuse_foreign(out, lambda data: digest in data)
        return
    names = files_of(stored, prefix)
    check_folder(out, names)
    refuse_foreign(out / "README.md", lambda data: digest in data)
    for name in names:
        refuse_foreign(out / name, lambda data: OURS in data)


@command("brake-cal tables compare sedan.dcm")
def compare(file: Path = argument("Exported DCM or CDF file.", "FILE"), *, store: Tables) -> Answer:
    """Compare a DCM or CDF file with the table that it names.

    Another tool may have saved the file: labels are compared, and numbers that were rounded agree.
    Exit code 3 if the file cannot be read or names no table, 4 if it differs from the table.
    """
    from calib.exports.compare import difference, parent
    from calib.exports.read import read_back
    from calib.show.store import returned, returned_document

    returned_file = read_back(file)
    stored = parent(returned_file, store)
    differences = difference(returned_file, stored)
    result = returned_file, stored, differences
    code = DAMAGED if differences.wrong else 0
    return Answer(returned_document(*result), returned(*result), code)


@command("brake-cal tables merge car@1 car@2 car@3 --name golden")
def merge(
    tables: list[str] = argument("Versions or paths, one of each car.", "CAR@1 CAR@2 ..."),
    *,
    name: str = option("Name of the mean table.", "NAME"),
    store: Tables,
) -> Answer:
    """Store the mean of several cars as a golden table.

    The table has the spread between the cars, and the bands of one more car of the model.
    """
    from calib.show.store import merged, merged_document
    from calib.store.merge import merge as mean_of

    stored = store.save(mean_of([store.load(table) for table in tables], name))
    return Answer(merged_document(stored), merged(stored))
