"""The C of a version in one call: in an FMU, or the folder that an ECU project takes in.

    bte.h bte.c                 the estimator, the same for every car of a precision
    bte_car.c                   the numbers of the car
    bte.a2l bte.dcm bte.cdfx    its maps for a calibration tool
    bte_run.c bte_vectors.h     samples with the answers of Python, and a program that compares
    README.md CMakeLists.txt

Nothing is made again in the ECU project: functions are called, and files are replaced.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from string import Template
from typing import Any

import numpy as np

from calib.base.errors import ExchangeError
from calib.base.plain import counted
from calib.base.write import publish, workshop, write_whole
from calib.car.model import default_model
from calib.ecu.car_source import (
    PREFIX,
    SOURCE,
    axes_of,
    cell,
    code_grids,
    initial,
    sources,
)
from calib.ecu.fmu import Content, Version, write_fmu
from calib.estimation.online import A_X, ANSWERS, CHANNELS, FL, answered, limits, samples_of
from calib.exports.addresses import find_addresses
from calib.exports.build import build
from calib.exports.export import require_handed_out
from calib.exports.write import FORMATS, as_comment
from calib.model.sensor_noise import add_noise
from calib.model.simulate import simulate
from calib.run.blocks import samples_of_block
from calib.store.evidence import UNPROVED, Quality
from calib.store.version import Stored
from calib.table.exported import Precision, as_exported
from calib.table.table import Table

FOLDER = "ecu"  # the format that is a folder; the others are one file each
_TOOLS = ("a2l", "cdfx", "dcm")  # formats of calibration tools, by the ending of the file
_GIVEN = ("bte_run.c", "CMakeLists.txt", "README.md")
_MADE = ("bte.h", "bte.c", "bte_car.c", "bte_vectors.h", *(f"bte.{form}" for form in _TOOLS))
_HEADERS = (
    " assert complex ctype errno features fenv float inttypes iso646 limits locale math setjmp "
    "signal stdarg stdbool stddef stdint stdio stdlib string tgmath time wchar wctype "
)
OURS = b"brake-cal"  # what every file of the folder has in it


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
    """Names in the folder of an ECU. Raises ExchangeError for a prefix that C does not take."""
    first = PREFIX if prefix is None else prefix
    if not re.fullmatch("[A-Za-z][A-Za-z0-9_]{0,15}", first) or f" {first} " in _HEADERS:
        expected = "a letter, then up to 15 of letters, digits and _, and no header of C"
        raise ExchangeError(f"the prefix {first!r}", expected=expected)
    return [_renamed(name, first) for name in (*_GIVEN, *_MADE)]


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
    sample_time : of the ECU's task, from call to call [s].
    prefix, elf, quality : of a folder alone: of every label and file; the linked program with the
        code, for the addresses in the A2L; result of a validation, for the state in the CDF.
    without_effects, unreleased : what may be handed out, see `require_handed_out`.

    Raises ExchangeError for what no code can have, StoreError for a version that is not handed out
    or has effects that the code does not take out, ProgramError where ``elf`` does not hold the
    table, OSError.
    """
    require_handed_out(stored, without_effects, unreleased=unreleased)
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
    files_of(first)
    files = _write_bundle(stored, out, how, sample_time, first, quality, elf)
    axes = axes_of(code_grids(stored.table, first, how))
    notes = tuple(f"{axis.label}: {axis.placed}" for axis in axes if axis.reduced)
    made = tuple(path.name for path in files)
    return WrittenCode(stored, out, form, how, sample_time, made, notes)


def _write_bundle(
    stored: Stored,
    folder: Path,
    how: Precision,
    sample_time: float,
    prefix: str,
    quality: Quality,
    elf: Path | None,
) -> list[Path]:
    texts = sources(stored.table, sample_time, how, "$about", stored.version)
    texts |= {name: (SOURCE / name).read_text(encoding="utf-8") for name in _GIVEN}
    texts["bte_vectors.h"] = "\n".join(_vectors(as_exported(stored.table, how), sample_time, how))
    about = f"By brake-cal: {stored.id}, digest {stored.digest}, {stored.state.words}"
    facts = {
        "about": as_comment(about),
        "table": stored.id, "digest": stored.digest, "state": stored.state.words,
        "bits": how.floating, "cell": cell(how), "step": f"{sample_time:g}",
        "ms": f"{1e3 * sample_time:g}_ms".replace(".", "_"),
        "inputs": "\n".join(_inputs(sample_time)),
        "answers": "\n".join(f"| `{x.name}` | {x.unit} | {x.meaning} |" for x in ANSWERS.values()),
    }  # fmt: skip
    date, single = datetime.now(UTC).date().isoformat(), how.floating == 32
    whole = build(stored, how.points, quality, how.bits, date, first=prefix)
    version = replace(whole.scalars[0], fixed=None)
    shown = replace(whole, curves=(), scalars=(version,), single=single)
    with workshop(folder) as work:
        for name, text in texts.items():
            content = Template(_renamed(text, prefix)).safe_substitute(facts)
            write_whole(work / _renamed(name, prefix), content.encode())
        for form in _TOOLS:
            grids = code_grids(stored.table, prefix, how, FORMATS[form].most_axes)
            data = replace(shown, axes=tuple(axes_of(grids)), grids=tuple(grids))
            if elf is not None and FORMATS[form].addressed:
                data = replace(data, addresses=find_addresses(elf, data))
            write_whole(work / f"{prefix}.{form}", FORMATS[form].write(data))
        return publish(work, folder, "README.md")


def _inputs(sample_time: float) -> Iterator[str]:
    """Rows of a table of what the code reads."""
    for x, low, high, jump in zip(CHANNELS.values(), *limits(sample_time), strict=True):
        most = f"{jump:g}" if jump < high - low else ""
        yield f"| `{x.name}` | {x.unit} | {low:g} to {high:g} | {most} | {x.meaning} |"


def _renamed(text: str, prefix: str) -> str:
    """The same with another prefix, in capitals where it is."""
    with_prefix = {PREFIX: prefix, PREFIX.upper(): prefix.upper()}
    return re.sub("|".join(with_prefix), lambda found: with_prefix[found[0]], text)


def _vectors(table: Table, sample_time: float, how: Precision) -> Iterator[str]:
    """bte_vectors.h: samples of a noisy stop, and the answers at the ends of the blocks.

    It rolls, brakes in two steps, and near the end a wheel locks and a sensor fails.
    """
    time = np.arange(0.0, 6.0, sample_time)
    braked = np.clip((time - 3.0) / 0.3, 0.0, 1.0) + (time > 4.5)
    log = simulate(default_model(table.vehicle), time, 15e5 * braked, 30.0, name="vectors")
    samples = samples_of(add_noise(log, seed=1))
    samples[log.time > log.time[-1] - 0.5, FL] *= 0.5
    samples[-5:, A_X] = 99.0
    samples = how.computed(samples)
    every, bits = samples_of_block(sample_time), how.floating
    yield f"/* Answers of brake-cal to {len(samples)} samples, of each block of {every}. */"
    yield f"#define COUNT {len(samples)}U\n#define EVERY {every}U"
    yield f"#define TOLERANCE {1e-9 if bits == 64 else 1e-4}"
    kept = answered(table, sample_time, samples)[every - 1 :: every]
    for name, rows in (("inputs[][BTE_INPUTS]", samples), ("expected[][BTE_TOLD]", kept)):
        cells = initial(rows.tolist(), bits).replace("}, ", "},\n")
        yield f"static const bte_real {name} = {cells};\n"
