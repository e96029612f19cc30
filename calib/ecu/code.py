"""The C of a version in one call: in an FMU, or the folder that an ECU project takes in.

    bte.h bte.c                 the estimator, the same for every car of a precision
    bte_car_NAME.c              the data of the car, with NAME_ before every label
    bte_car_NAME.a2l .dcm .cdfx its data for a calibration tool
    bte_run.c bte_vectors.h     samples with the answers of Python, and a program that compares
    README.md CMakeLists.txt

An ECU project calls the functions and replaces the files; it edits none.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from string import Template
from typing import Any

import numpy as np

from calib.base.errors import ExchangeError
from calib.base.names import CHANNELS as LOGGED
from calib.base.plain import counted
from calib.base.write import publish, work_folder, write_whole
from calib.car.model import default_model
from calib.car.vehicle import Vehicle
from calib.ecu.car_data import CAR, axes_of, code_grids, numbers_of, sources
from calib.ecu.car_source import SOURCE, cell, initial
from calib.ecu.fmu import Content, Version, compile_fmu, write_fmu
from calib.ecu.memory import calibrated, measured
from calib.estimation.online import A_X, ANSWERS, CHANNELS, FL, answered, limits, samples_of
from calib.exports.addresses import find_addresses
from calib.exports.build import build
from calib.exports.export import require_handed_out
from calib.exports.symbols import prefix
from calib.exports.write import FORMATS, as_comment
from calib.model.sensor_noise import add_noise
from calib.model.simulate import simulate
from calib.run.blocks import samples_of_block
from calib.store.version import Stored
from calib.table.exported import Precision, as_exported
from calib.table.table import Table

FOLDER = "ecu"  # the format that is a folder; the others are one file each
_TOOLS = ("a2l", "cdfx", "dcm")  # formats of calibration tools, by the ending of the file
_GIVEN = ("bte_run.c", "CMakeLists.txt", "README.md")
_MADE = ("bte.h", "bte.c", "bte_vectors.h")
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


def files_of(stored: Stored, first: str | None) -> list[str]:
    """Names in the folder of an ECU, with the ``first`` part of the labels of the car."""
    car = f"{CAR}_{prefix(stored.name if first is None else first)}"
    return [*_GIVEN, *_MADE, *(f"{car}.{form}" for form in ("c", *_TOOLS))]


def write_code(
    stored: Stored,
    out: Path,
    form: str,
    how: Precision,
    sample_time: float,
    first: str | None = None,
    *,
    elf: Path | None = None,
    without_effects: Sequence[str] = (),
    unreleased: bool = False,
    compiled: bool = False,
) -> WrittenCode:
    """Write the estimator, or the simulated car, with the numbers of a version.

    Parameters
    ----------
    form : ``ecu``, a folder; ``fmu2`` or ``fmu3``, the same in an FMU; ``car-fmu2`` or
        ``car-fmu3``, an FMU of the car whose sensors that one reads.
    sample_time : of the ECU's task, from call to call [s].
    first, elf : of a folder alone: first part of the labels of the data, of the table's name if
        not given; the linked program with the code, for the addresses in the A2L.
    compiled : of an FMU alone: with a binary for this machine, too, by FMPy.
    without_effects, unreleased : what may be handed out, see `require_handed_out`.

    Raises StoreError for a version that is not handed out or has effects that the code cannot take
    out, ExchangeError for other options, ProgramError where ``elf`` holds another table, OSError.
    """
    require_handed_out(stored, without_effects, unreleased=unreleased)
    car = stored.table.vehicle
    car = replace(car, effects=car.effects.without(*without_effects))
    stored = replace(stored, table=replace(stored.table, vehicle=car))
    if form == FOLDER and compiled:
        raise ExchangeError("only an FMU is compiled", expected="fmu2, fmu3 and those of the car")
    if form != FOLDER:
        if elf or first is not None:
            raise ExchangeError("an FMU has no --elf, --prefix")
        version: Version = 2 if form.endswith("2") else 3
        content: Content = "car" if form.startswith("car") else "estimator"
        write_fmu(stored, out, how, sample_time, version, content)
        if compiled:
            compile_fmu(out)
        return WrittenCode(stored, out, form, how, sample_time, (out.name,))
    first = prefix(stored.name if first is None else first)
    files = _write_bundle(stored, out, how, sample_time, first, elf)
    axes = axes_of(code_grids(stored.table, first, how))
    notes = tuple(f"{axis.label}: {axis.placed}" for axis in axes if axis.reduced)
    names = tuple(path.name for path in files)
    return WrittenCode(stored, out, form, how, sample_time, names, notes)


def _write_bundle(
    stored: Stored, folder: Path, how: Precision, sample_time: float, first: str, elf: Path | None
) -> list[Path]:
    texts = sources(stored.table, sample_time, how, first, stored.version, stored.digest)
    texts |= {name: (SOURCE / name).read_text(encoding="utf-8") for name in _GIVEN}
    texts["bte_vectors.h"] = "\n".join(_vectors(as_exported(stored.table, how), sample_time, how))
    about = f"By brake-cal: {stored.id}, digest {stored.digest}, {stored.state.description}"
    facts = {
        "about": as_comment(about), "car": f"{CAR}_{first}", "first": first,
        "table": stored.id, "digest": stored.digest, "state": stored.state.description,
        "bits": how.floating, "cell": cell(how), "step": f"{sample_time:g}",
        "ms": f"{1e3 * sample_time:g}_ms".replace(".", "_"),
        "inputs": "\n".join(_inputs(sample_time, stored.table.vehicle)),
        "answers": "\n".join(f"| `{x.name}` | {x.unit} | {x.meaning} |" for x in ANSWERS.values()),
    }  # fmt: skip
    whole = build(stored, how.points, how.bits, first=first)
    version = replace(whole.scalars[0], fixed=None)
    shown = replace(whole, curves=(), scalars=(version,), single=how.floating == 32)
    with work_folder(folder) as work:
        for name, text in texts.items():
            write_whole(work / name, Template(text).safe_substitute(facts).encode())
        for form in _TOOLS:
            grids = code_grids(stored.table, first, how, FORMATS[form].most_axes)
            data = replace(shown, axes=tuple(axes_of(grids)), maps=tuple(grids))
            if FORMATS[form].addressed:
                numbers = calibrated(
                    numbers_of(stored.table, sample_time, stored.version), first, how.floating // 8
                )
                tool = tuple(measured(first, how.floating // 8))
                data = replace(data, scalars=tuple(numbers), measured=tool)
                data = replace(data, addresses=find_addresses(elf, data)) if elf else data
            write_whole(work / f"{CAR}_{first}.{form}", FORMATS[form].write(data))
        return publish(work, folder, "README.md")


def _inputs(sample_time: float, car: Vehicle) -> Iterator[str]:
    """Rows of a table of what the code reads."""
    for x, low, high, jump in zip(CHANNELS.values(), *limits(sample_time, car), strict=True):
        most = f"{jump:g}" if jump < high - low else ""
        yield f"| `{x.name}` | {x.unit} | {low:g} to {high:g} | {most} | {x.meaning} |"


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
    answers = answered(table, sample_time, samples)[every - 1 :: every]
    yield f"/* Answers of brake-cal to {len(samples)} samples, of each block of {every}. */"
    yield '#ifndef BTE_VECTORS_H\n#define BTE_VECTORS_H\n\n#include "bte.h"\n'
    yield f"#define BTE_VECTORS_COUNT {len(samples)}U\n#define BTE_VECTORS_EVERY {every}U"
    yield f"#define BTE_VECTORS_TOLERANCE {1e-9 if bits == 64 else 1e-4}"
    yield "#define BTE_VECTORS_CAR (&$car)\nextern const bte_car $car;\n"
    units = {x.name: LOGGED[x.name].si if x.name in LOGGED else x.unit for x in CHANNELS.values()}
    needed = sum(name in LOGGED and LOGGED[name].required for name in CHANNELS)
    yield f"#define BTE_VECTORS_NEEDED {needed} /* columns that a log has; others may be 0 */"
    columns = ", ".join(f'"{name} [{unit}]"' for name, unit in units.items())
    names = (f"{x}{end}" for x in ANSWERS for end in ("", "_lower", "_upper"))
    for name, text in (
        ("char *const bte_vectors_columns[]", f"{{{columns}}}"),
        ("char bte_vectors_header[]", f'"time,reason,{",".join(names)}"'),
        (f"bte_real bte_vectors_inputs[][{samples.shape[1]}]", initial(samples.tolist(), bits)),
        (f"bte_real bte_vectors_answers[][{answers.shape[1]}]", initial(answers.tolist(), bits)),
    ):
        cells = text.replace("}, ", "},\n")
        yield f"extern const {name};\nconst {name} = {cells};\n"
    yield "#endif\n"
