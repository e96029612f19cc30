"""The folder that an ECU project takes in: the estimator, this car's numbers, and their proof.

    bte.h bte.c                 the estimator, the same for every car of a precision
    bte_car.c                   the numbers of the car
    bte.a2l bte.dcm bte.cdfx    its maps for a calibration tool
    bte_run.c bte_vectors.h     samples with the answers of Python, and a program that compares
    README.md CMakeLists.txt

Nothing is made again in the ECU project: functions are called, and files are replaced.
"""

import re
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from string import Template

import numpy as np

from calib.base.errors import ExchangeError
from calib.base.write import publish, workshop, write_whole
from calib.car.model import default_model
from calib.ecu import car_source
from calib.estimation.online import A_X, ANSWERS, CHANNELS, FL, answered, limits, samples_of
from calib.exports.addresses import find_addresses
from calib.exports.build import build
from calib.exports.filters import as_comment
from calib.exports.write import FORMATS
from calib.model.sensor_noise import add_noise
from calib.model.simulate import simulate
from calib.run.blocks import samples_of_block
from calib.store.evidence import UNPROVED, Quality
from calib.store.version import Stored
from calib.table.exported import Precision, as_exported
from calib.table.table import Table

TOOLS = ("a2l", "cdfx", "dcm")
"""Formats of calibration tools, by the ending of the file."""
_GIVEN = ("bte_run.c", "CMakeLists.txt", "README.md")
_MADE = ("bte.h", "bte.c", "bte_car.c", "bte_vectors.h", *(f"bte.{form}" for form in TOOLS))
_HEADERS = (
    " assert complex ctype errno features fenv float inttypes iso646 limits locale math setjmp "
    "signal stdarg stdbool stddef stdint stdio stdlib string tgmath time wchar wctype "
)
OURS = b"brake-cal"
"""What every file of the folder has in it."""


def names(prefix: str = car_source.PREFIX) -> list[str]:
    """Files of the folder."""
    return [_renamed(name, prefix) for name in (*_GIVEN, *_MADE)]


def require_prefix(prefix: str) -> None:
    """Raise ExchangeError for a name that C does not take for files and labels."""
    if not re.fullmatch("[A-Za-z][A-Za-z0-9_]{0,15}", prefix) or f" {prefix} " in _HEADERS:
        expected = "a letter, then up to 15 of letters, digits and _, and no header of C"
        raise ExchangeError(f"the prefix {prefix!r}", expected=expected)


def write_bundle(
    stored: Stored,
    folder: Path,
    how: Precision,
    sample_time: float,
    prefix: str = car_source.PREFIX,
    *,
    quality: Quality = UNPROVED,
    elf: Path | None = None,
) -> list[Path]:
    """Write the code of a version to a folder, and return the files.

    Parameters
    ----------
    sample_time : of the ECU's task [s].
    prefix : of every label and file.
    quality : result of a validation, for the state in the CDF.
    elf : linked program with the code, for the addresses in the A2L.

    Raises StoreError for a table without maps, or with known effects that the code does not take
    out; ExchangeError for a name that C does not take, or a time of no ECU; ProgramError
    where ``elf`` does not hold the table.
    """
    require_prefix(prefix)
    texts = car_source.sources(stored.table, sample_time, how, "$about", stored.version)
    texts |= {name: (car_source.SOURCE / name).read_text(encoding="utf-8") for name in _GIVEN}
    texts["bte_vectors.h"] = "\n".join(_vectors(as_exported(stored.table, how), sample_time, how))
    about = f"By brake-cal: {stored.id}, digest {stored.digest}, {stored.state.words}"
    facts = {
        "about": as_comment(about),
        "table": stored.id, "digest": stored.digest, "state": stored.state.words,
        "bits": how.floating, "cell": car_source.cell(how), "step": f"{sample_time:g}",
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
        for form in TOOLS:
            grids = car_source.code_grids(stored.table, prefix, how, FORMATS[form].most_axes)
            data = replace(shown, axes=tuple(car_source.axes_of(grids)), grids=tuple(grids))
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
    with_prefix = {car_source.PREFIX: prefix, car_source.PREFIX.upper(): prefix.upper()}
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
        cells = car_source.initial(rows.tolist(), bits).replace("}, ", "},\n")
        yield f"static const bte_real {name} = {cells};\n"
