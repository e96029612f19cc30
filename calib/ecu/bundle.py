"""The folder that an ECU project takes in: the estimator, this car's numbers, and their proof.

    bte.h bte.c                 the estimator, the same for every car
    bte_config.h bte_car.c      precision, and the numbers of the car
    bte.a2l bte.dcm bte.cdfx    its maps for a calibration tool
    bte_run.c vectors.h         samples with the answers of Python, and a program that compares
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

from calib.base.arrays import Array
from calib.base.errors import ExchangeError
from calib.base.publish import publish, workshop
from calib.base.write import write_whole
from calib.car.model import default_model
from calib.ecu.car_source import CONFIG, PREFIX, SOURCE, require_time, sources
from calib.ecu.channels import A_X, CHANNELS, FL, limits, samples_of
from calib.ecu.labels import code_data
from calib.ecu.native import OUTPUTS
from calib.ecu.online import Online, Timing
from calib.ecu.width import Width
from calib.exports.addresses import find_addresses
from calib.exports.write import FORMATS
from calib.model.sensor_noise import add_noise
from calib.model.simulate import simulate
from calib.store.evidence import UNPROVED, Quality
from calib.store.version import Stored
from calib.table.exported import as_exported
from calib.table.generation import require_maps
from calib.table.table import Table

README = "README.md"
TOOLS = ("a2l", "cdfx", "dcm")
"""Formats of calibration tools, by the ending of the file."""
_TOLERANCE = {64: 1e-9, 32: 1e-4}
"""Relative difference of the vectors from Python by the bits of the floating point."""

OURS = b"brake-cal"
"""What every file of the folder has in it."""

_HEADERS = frozenset(
    """assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal
    stdarg stdbool stddef stdint stdio stdlib string tgmath time wchar wctype""".split()  # noqa: SIM905
)
"""Headers of C: a file of that name would stand before them."""

_ROLLED, _BRAKED = 3.0, 3.0  # time of the vectors without and with brake [s]
_SEED = 1


def names(prefix: str = PREFIX) -> tuple[str, ...]:
    """Files of the folder."""
    given = sorted(path.name for path in SOURCE.iterdir() if path.suffix in (".c", ".h"))
    made = ("bte_config.h", "bte_car.c", "vectors.h", "CMakeLists.txt", README)
    of_tools = (f"{PREFIX}.{form}" for form in TOOLS)
    return tuple(_renamed(name, prefix) for name in (*given, *made, *of_tools))


def require_prefix(prefix: str) -> None:
    """Raise ExchangeError for a name that C does not take for files and labels."""
    if not re.fullmatch("[A-Za-z][A-Za-z0-9_]{0,15}", prefix) or prefix in _HEADERS:
        expected = "a letter, then up to 15 of letters, digits and _, and no header of C"
        raise ExchangeError(f"the prefix {prefix!r}", expected=expected)


def write_bundle(
    stored: Stored,
    folder: Path,
    width: Width,
    sample_time: float,
    prefix: str = PREFIX,
    *,
    quality: Quality = UNPROVED,
    elf: Path | None = None,
) -> list[Path]:
    """Write the code of a version to a folder, replace files of the same names, return all.

    Parameters
    ----------
    sample_time : of the ECU's task [s].
    prefix : of every label and file.
    quality : result of a validation, for the state in the CDF.
    elf : linked program with the code, for the addresses in the A2L.

    Raises StoreError for a table without maps, or with known effects that the code does not take
    out; ExchangeError for a name that C does not take, or a time without a block; ProgramError
    where ``elf`` does not hold the table.
    """
    require_prefix(prefix)
    require_time(sample_time)
    require_maps(stored.table, stored.id)
    samples, told = vectors(as_exported(stored.table, width.how), sample_time, width)
    state = stored.state.words.replace("*/", "* /")
    about = f"By brake-cal: {stored.id}, digest {stored.digest}, {state}"
    texts = {path.name: path.read_text() for path in sorted(SOURCE.iterdir()) if path.is_file()}
    texts |= sources(stored.table, sample_time, width, "$about", stored.version)
    texts["vectors.h"] = "\n".join(_vectors(samples, told, sample_time, width)) + "\n"
    renamed = {name: _renamed(text, prefix) for name, text in texts.items()}
    renamed["bte_car.c"] = renamed["bte_car.c"].replace("$about", about)
    renamed[README] = Template(renamed[README]).substitute(
        table=stored.id, digest=stored.digest, state=stored.state.words, bits=width.bits,
        cell=width.cell, step=f"{sample_time:g}", ms=f"{1e3 * sample_time:g}_ms".replace(".", "_"),
        count=len(samples), inputs="\n".join(_inputs(sample_time)),
    )  # fmt: skip
    files = {_renamed(name, prefix): text.encode() for name, text in renamed.items()}
    files |= _for_tools(stored, width, prefix, quality, elf)
    with workshop(folder) as work:
        for name, content in files.items():
            write_whole(work / name, content)
        return publish(work, folder, README, _of_any_prefix)


def _of_any_prefix(folder: Path) -> Iterator[str]:
    """Files of this program in a folder, whatever their prefix was."""
    end = _renamed("bte_config.h", "")
    for config in folder.glob(f"*{end}"):
        if config.read_bytes().startswith(CONFIG.encode()):
            for name in names(config.name.removesuffix(end)):
                if (folder / name).is_file() and OURS in (folder / name).read_bytes():
                    yield name


def _inputs(sample_time: float) -> Iterator[str]:
    """Rows of a table of what the code reads."""
    for (name, x), low, high, jump in zip(CHANNELS.items(), *limits(sample_time), strict=True):
        most = f"{jump:g}" if jump < high - low else ""
        yield f"| `{name}` | {x.unit} | {low:g} to {high:g} | {most} | {x.meaning} |"


def _for_tools(
    stored: Stored, width: Width, prefix: str, quality: Quality, elf: Path | None
) -> dict[str, bytes]:
    """The maps in the formats of calibration tools, by the name of the file."""
    date, out = datetime.now(UTC).date().isoformat(), {}
    for form in TOOLS:
        most = FORMATS[form].most_axes
        data = code_data(stored, prefix, width, date, quality, most)
        if elf is not None and FORMATS[form].addressed:
            data = replace(data, addresses=find_addresses(elf, data))
        out[f"{prefix}.{form}"] = FORMATS[form].write(data)
    return out


def _renamed(text: str, prefix: str) -> str:
    """The same with another prefix, in capitals where it is."""
    return text.replace("bte", prefix).replace("BTE", prefix.upper())


def vectors(table: Table, sample_time: float, width: Width) -> tuple[Array, Array]:
    """Samples (n, 10) of a noisy stop of the table's car, and Python's answers (n, 22).

    It rolls, brakes in two steps, and near the end a wheel locks and a sensor fails.
    """
    time = np.arange(0.0, _ROLLED + _BRAKED, sample_time)
    braked = np.clip((time - _ROLLED) / 0.3, 0.0, 1.0) + (time > _ROLLED + 1.5)
    car = table.vehicle
    log = add_noise(simulate(default_model(car), time, 15e5 * braked, 30.0, name="vectors"), _SEED)
    samples = width.rounded(samples_of(log))
    late = log.time > log.time[-1] - 0.5
    samples[late, FL] *= 0.5
    samples[-5:, A_X] = 99.0
    return samples, Online(table, sample_time).run(samples)


def _vectors(samples: Array, told: Array, sample_time: float, width: Width) -> Iterator[str]:
    """vectors.h: every sample, and the answers at the ends of the blocks."""
    every = Timing.of(sample_time).samples
    kept = told[every - 1 :: every]
    yield f"/* Answers of brake-cal to {len(samples)} samples, of each block of {every}. */"
    yield f"#define COUNT {len(samples)}U\n#define EVERY {every}U"
    yield f"#define TOLERANCE {_TOLERANCE[width.bits]:g}"
    for name, rows in (("inputs", samples), ("expected", kept)):
        cells = ",\n".join(", ".join(map(width.number, row)) for row in rows.tolist())
        yield f"static const bte_real {name}[] = {{\n{cells}\n}};"
    assert kept.shape[1] == OUTPUTS
