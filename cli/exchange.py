"""`brake-cal tables export`, `compare` and `merge`: tables leave a store and come back."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cli.command import DAMAGED, Answer, command
from cli.console import at_option, misuse, say
from cli.options import Table, Tables, argument, option
from cli.outputs import EITHER, check_file, check_folder, refuse_foreign, writing
from cli.sign import Signed

if TYPE_CHECKING:
    from calib.store.version import Stored
    from calib.table.exported import Precision

_BITS = "In integers of 8, 16 or 32 bits; for c-header, a2l, ecu and FMUs."
_SINGLE = "In single precision; for c-header, a2l, ecu and FMUs."


@dataclass(frozen=True)
class Shape:
    """Breakpoints and precision of an exported table."""

    points: Annotated[int | None, option("Breakpoints on each axis; else all rows.", "N")]
    bits: Annotated[int | None, option(_BITS, "BITS", "--fixed-point")]
    single: Annotated[bool, option(_SINGLE, None, "--float")]
    double: Annotated[bool, option("In double precision: the code for an ECU else is in single.")]

    def precision(self, code: bool = False) -> "Precision | None":
        """The precision typed, of C ``code`` or not; None for the full table."""
        from calib.base.errors import ExchangeError
        from calib.table.exported import Precision

        if self.double and (self.single or self.bits):
            raise misuse("one of --float, --fixed-point and --double", "--double")
        if (self.points, self.bits, self.single, code) == (None, None, False, False):
            return None
        single = self.single or (code and not self.double and self.bits is None)
        with at_option("--points, --fixed-point, --float", ExchangeError):
            return Precision(self.points, self.bits, single, code)


@command(
    "brake-cal tables export sedan-2up --out sedan.dcm",
    "brake-cal tables export sedan-2up --format ecu --sample-time 0.005 --out bte",
)
def export(
    table: Table,
    *,
    form: str | None = option("Format, see `manual tables`; else by --out.", "F", "--format"),
    out: Path = option("File to write, or the folder of the code.", "FILE", writes=EITHER),
    shape: Shape,
    sample_time: float | None = option("Time of a step [s] of code; else of the logs.", "S"),
    prefix: str | None = option("First part of all labels; else the table's name.", "NAME"),
    elf: Path | None = option("Linked program (ELF), for addresses of an A2L.", "FILE"),
    compiled: bool = option("With a binary for this machine in an FMU; needs FMPy and cmake."),
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
    from calib.base.errors import ExchangeError
    from calib.ecu.code import FOLDER, write_code
    from calib.exports.export import CODES
    from calib.exports.export import export as write
    from calib.table.exported import Precision

    stored = store.load(table) if unreleased else store.released(table)
    signed.check(table, stored)
    kind = (form or "").lower()
    _check_out(out, stored, prefix, kind == FOLDER)
    choices: dict[str, Any] = {
        "elf": elf,
        "unreleased": unreleased,
        "without_effects": without_effect,
    }
    if kind not in CODES and (sample_time is not None or compiled):
        raise misuse(f"for --format {', '.join(CODES)} alone", "--sample-time, --compiled")
    written: Any
    with at_option(None, ExchangeError), writing(out):
        if kind in CODES:
            how, step = shape.precision(kind == FOLDER) or Precision(), sample_time
            if step is None and (step := stored.table.provenance.sample_time) is None:
                why = "needed: the table does not say that of its logs, or they differ"
                raise misuse(why, "--sample-time")
            code = how, step, prefix
            written = write_code(stored, out, kind, *code, compiled=compiled, **choices)
        else:
            choices |= {"points": shape.points, "bits": shape.bits, "single": shape.single}
            written = write(stored, out, form, prefix=prefix, **choices)
    for note in written.notes:
        say(note)
    return Answer(written.to_dict(), repr(written))


def _check_out(out: Path, stored: "Stored", prefix: str | None, folder: bool) -> None:
    """Refuse a place that holds anything but an export of this version."""
    from calib.ecu.code import OURS, files_of

    names, digest = files_of(stored, prefix) if folder else [], stored.digest.encode()
    if folder:
        check_folder(out, names)
    else:
        check_file(out)
    refuse_foreign(out / "README.md" if folder else out, lambda data: digest in data)
    for name in names:
        refuse_foreign(out / name, lambda data: OURS in data)


@command("brake-cal tables compare sedan.dcm")
def compare(file: Path = argument("Exported DCM or CDF file.", "FILE"), *, store: Tables) -> Answer:
    """Compare a DCM or CDF file with the table that it names.

    Exit code 3 if it is cut off, damaged or names no table, 4 if it does not agree with the table.
    Another tool may have saved it: labels are compared, and numbers that were rounded agree.
    """
    from calib.exports.compare import difference, parent
    from calib.exports.read import read_back
    from calib.show.store import returned, returned_document

    returned_file = read_back(file)
    stored = parent(returned_file, store)
    differences = difference(returned_file, stored)
    result = returned_file, stored, differences
    return Answer(returned_document(*result), returned(*result), DAMAGED * bool(differences.wrong))


@command("brake-cal tables merge car@1 car@2 car@3 --name golden")
def merge(
    tables: list[str] = argument("name@version or path, one of each car", "CAR@1 CAR@2 ..."),
    *,
    name: str = option("Name of the mean table.", "NAME"),
    store: Tables,
) -> Answer:
    """Store the mean of several cars as a golden table.

    With the spread between them; its bands are those of one more car of the model.
    """
    from calib.show.store import merged, merged_document
    from calib.store.merge import merge as mean_of

    stored = store.save(mean_of([store.load(table) for table in tables], name))
    return Answer(merged_document(stored), merged(stored))
