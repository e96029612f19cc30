"""Write the C of a version: as an FMU, or as a folder for the project of an ECU.

    bte.h bte.c                  the estimator, the same for every car of a precision
    bte_car_NAME.c               the data of the car, with NAME_ before every label
    bte_car_NAME.a2l .dcm .cdfx  the data for a calibration tool
    bte_run.c bte_vectors.h      samples with the answers of Python, and a program that compares
    README.md CMakeLists.txt

A project calls the functions of bte.h. To update, it replaces the files; it edits none of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from calib.base.errors import ExchangeError
from calib.base.names import CHANNELS as LOGGED
from calib.base.plain import counted
from calib.base.write import publish, work_folder, write_whole
from calib.car.model import default_model
from calib.ecu.car_data import CAR, axes_of, code_grids, numbers_of, sources
from calib.ecu.fmu import Content, Version, compile_fmu, write_fmu
from calib.ecu.structures import calibrated, cell, initial, measured, source
from calib.estimation.online import A_X, ANSWERS, CHANNELS, FL, answered, limits, samples_of
from calib.estimation.readout import ENDS
from calib.exports.addresses import find_addresses
from calib.exports.build import build
from calib.exports.export import CODES, require_handed_out
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
_COPIED = ("bte_run.c", "CMakeLists.txt", "README.md")
OURS = b"brake-cal"  # a text in every file of the folder


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
        """Return the JSON document of an export of code."""
        stored, how = self.stored, self.how
        return {
            "table": stored.id, "digest": stored.digest, "version": stored.version,
            "format": self.form, "out": self.out, "files": self.files,
            "float": how.floating, "cell": cell(how), "sample_time": self.sample_time,
        }  # fmt: skip


def files_of(stored: Stored, first: str | None) -> list[str]:
    """Return the names of the files for an ECU, whose labels begin with ``first``."""
    car = f"{CAR}_{prefix(stored.name if first is None else first)}"
    of_car = (f"{car}.{form}" for form in ("c", *_TOOLS))
    return [*_COPIED, "bte.h", "bte.c", "bte_vectors.h", *of_car]


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

    ``form`` is one of `calib.exports.export.CODES`, ``sample_time`` is the time between two calls
    of the ECU's task [s]. A folder may have labels that begin with ``first`` instead of the table's
    name, and takes the addresses of the A2L from ``elf``, the linked program. An FMU may be
    ``compiled`` for this machine. ``without_effects``, ``unreleased``: see `require_handed_out`.

    Raises StoreError for a version that may not be handed out or has effects that the code cannot
    take out, ExchangeError for options of the other forms, ProgramError where ``elf`` holds another
    table or nothing can be compiled, OSError.
    """
    require_handed_out(stored, without_effects, unreleased=unreleased)
    car = stored.table.vehicle
    car = replace(car, effects=car.effects.without(*without_effects))
    stored = replace(stored, table=replace(stored.table, vehicle=car))
    if form == FOLDER:
        if compiled:
            raise ExchangeError("only an FMU is compiled", expected=", ".join(CODES[1:]))
        first = prefix(stored.name if first is None else first)
        files = tuple(_write_folder(stored, out, how, sample_time, first, elf))
        axes = axes_of(code_grids(stored.table, first, how))
        notes = tuple(f"{axis.label}: {axis.placed}" for axis in axes if axis.reduced)
        return WrittenCode(stored, out, form, how, sample_time, files, notes)
    if elf or first is not None:
        raise ExchangeError("an FMU has no --elf, --prefix")
    version: Version = 2 if form.endswith("2") else 3
    content: Content = "car" if form.startswith("car") else "estimator"
    write_fmu(stored, out, how, sample_time, version, content)
    if compiled:
        compile_fmu(out)
    return WrittenCode(stored, out, form, how, sample_time, (out.name,))


def _write_folder(
    stored: Stored, folder: Path, how: Precision, sample_time: float, first: str, elf: Path | None
) -> list[str]:
    """Write the folder of an ECU, and return the names of its files."""
    table, car, state = stored.table, f"{CAR}_{first}", stored.state.description
    about = as_comment(f"By brake-cal: {stored.id}, digest {stored.digest}, {state}")
    texts = sources(stored, sample_time, how, first, about)
    limited = zip(CHANNELS.values(), *limits(sample_time, table.vehicle), strict=True)
    facts = {
        "car": car, "table": stored.id, "digest": stored.digest, "state": state,
        "bits": how.floating, "cell": cell(how), "step": f"{sample_time:g}",
        "ms": f"{1e3 * sample_time:g}_ms".replace(".", "_"), "answers": ANSWERS.values(),
        "inputs": [x._replace(low=low, high=high, jump=jump) for x, low, high, jump in limited],
    }  # fmt: skip
    texts |= {name: source(name, **facts) for name in _COPIED}
    texts["bte_vectors.h"] = _vectors(as_exported(table, how), sample_time, how, car)
    files = {name: text.encode() for name, text in texts.items()}
    # The files for tools have the maps of the C code and the version, but no curves; those with
    # addresses also have the scalars and the measured variables of the code.
    exported = build(stored, how.points, how.bits, first=first)
    version = replace(exported.scalars[0], fixed=None)  # "version", the first scalar
    common = replace(exported, curves=(), scalars=(version,), single=how.floating == 32)
    for form in _TOOLS:
        grids = code_grids(table, first, how, FORMATS[form].most_axes)
        data = replace(common, axes=tuple(axes_of(grids)), maps=tuple(grids))
        if FORMATS[form].addressed:
            size, numbers = how.floating // 8, numbers_of(stored, sample_time)
            scalars, members = calibrated(numbers, first, size), measured(first, size)
            data = replace(data, scalars=tuple(scalars), measured=tuple(members))
            data = replace(data, addresses=find_addresses(elf, data)) if elf else data
        files[f"{car}.{form}"] = FORMATS[form].write(data)
    with work_folder(folder) as work:
        for name, content in files.items():
            write_whole(work / name, content)
        return [path.name for path in publish(work, folder, "README.md")]


def _vectors(table: Table, sample_time: float, how: Precision, car: str) -> str:
    """Return bte_vectors.h: samples of a noisy stop, and the answers at the ends of the blocks.

    The car rolls and brakes in two steps; near the end a wheel locks, then a sensor fails.
    """
    time = np.arange(0.0, 6.0, sample_time)
    braked = np.clip((time - 3.0) / 0.3, 0.0, 1.0) + (time > 4.5)
    log = simulate(default_model(table.vehicle), time, 15e5 * braked, 30.0, name="vectors")
    samples = samples_of(add_noise(log, seed=1))
    samples[log.time > log.time[-1] - 0.5, FL] *= 0.5
    samples[-5:, A_X] = 99.0
    samples = how.computed(samples)
    size, bits = samples_of_block(sample_time), how.floating  # samples of a block
    answers = answered(table, sample_time, samples)[size - 1 :: size]
    units = {name: LOGGED[name].si if name in LOGGED else x.unit for name, x in CHANNELS.items()}
    facts = {
        "car": car, "count": len(samples), "every": size,
        "tolerance": 1e-9 if bits == 64 else 1e-4,
        "columns": [f"{name} [{unit}]" for name, unit in units.items()],
        "needed": sum(name in LOGGED and LOGGED[name].required for name in CHANNELS),
        "names": [f"{x}{end}" for x in ANSWERS for end in ENDS],
        "inputs": [initial(row, bits) for row in samples.tolist()],
        "answers": [initial(row, bits) for row in answers.tolist()],
    }  # fmt: skip
    return source("bte_vectors.h.j2", **facts)
