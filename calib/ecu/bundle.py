"""The folder that an ECU project takes in: the estimator, this car's numbers, and their proof.

bte.h bte.c                 the estimator, the same for every car
bte_config.h bte_car.c      precision, and the numbers of the car
bte_run.c vectors.h         samples with the answers of Python, and a program that compares
README.md CMakeLists.txt
"""

import re
from collections.abc import Iterator
from pathlib import Path
from string import Template

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ExchangeError
from calib.base.publish import publish, workshop
from calib.base.write import write_whole
from calib.car.model import default_model
from calib.ecu.car_source import Width, car_source, require_time
from calib.ecu.native import OUTPUTS, SOURCE, config, samples_of
from calib.ecu.online import RANGES, Online, Timing
from calib.model.sensor_noise import add_noise
from calib.model.simulate import simulate
from calib.store.version import Stored
from calib.table.exported import as_exported
from calib.table.generation import require_maps
from calib.table.table import Table

PREFIX = "bte"
README = "README.md"
_TOLERANCE = {64: 1e-9, 32: 1e-4}
"""Relative difference of the vectors from Python by the bits of the floating point."""

_ROLLED, _BRAKED = 3.0, 3.0  # time of the vectors without and with brake [s]
_SEED = 1


def names(prefix: str = PREFIX) -> tuple[str, ...]:
    """Files of the folder."""
    given = sorted(path.name for path in SOURCE.iterdir() if path.suffix in (".c", ".h"))
    made = (*given, "bte_config.h", "bte_car.c", "vectors.h", "CMakeLists.txt", README)
    return tuple(_renamed(name, prefix) for name in made)


def write_bundle(
    stored: Stored, folder: Path, width: Width, sample_time: float, prefix: str = PREFIX
) -> list[Path]:
    """Write the code of a version to a folder, replace files of the same names, return all.

    ``sample_time`` [s] of the ECU's task; ``prefix`` of every label and file. Raises StoreError for
    a table without maps, or with known effects that the code does not take out; ExchangeError for
    a name that C does not take, or a time without a block.
    """
    if not re.fullmatch("[A-Za-z][A-Za-z0-9_]{0,15}", prefix):
        raise ExchangeError(
            f"the prefix {prefix!r}", expected="a letter, then up to 15 of A-Z 0-9 _"
        )
    require_time(sample_time)
    require_maps(stored.table, stored.id)
    samples, told = vectors(as_exported(stored.table, width.how), sample_time, width)
    about = f"{stored.id}, digest {stored.digest}, {stored.state.words}".replace("*/", "* /")
    texts = {path.name: path.read_text() for path in sorted(SOURCE.iterdir()) if path.is_file()}
    texts["bte_config.h"] = config(width)
    texts["bte_car.c"] = car_source(stored.table, sample_time, width, about)
    texts["vectors.h"] = "\n".join(_vectors(samples, told, sample_time, width)) + "\n"
    texts[README] = Template(texts[README]).substitute(
        table=stored.id, digest=stored.digest, state=stored.state.words, bits=width.bits,
        cell=width.cell, step=f"{sample_time:g}", ms=f"{1e3 * sample_time:g}_ms".replace(".", "_"),
        count=len(samples),
    )  # fmt: skip
    with workshop(folder) as work:
        for name, text in texts.items():
            write_whole(work / _renamed(name, prefix), _renamed(text, prefix).encode())
        return publish(work, folder, README)


def _renamed(text: str, prefix: str) -> str:
    """The same with another prefix, in capitals where it is."""
    return text.replace("bte", prefix).replace("BTE", prefix.upper())


def vectors(table: Table, sample_time: float, width: Width) -> tuple[Array, Array]:
    """Samples (n, 8) of a noisy stop of the table's car, and Python's answers (n, 22).

    It rolls, brakes in two steps, and near the end a wheel locks and a sensor fails.
    """
    time = np.arange(0.0, _ROLLED + _BRAKED, sample_time)
    braked = np.clip((time - _ROLLED) / 0.3, 0.0, 1.0) + (time > _ROLLED + 1.5)
    car = table.vehicle
    log = add_noise(simulate(default_model(car), time, 15e5 * braked, 30.0, name="vectors"), _SEED)
    samples = width.rounded(samples_of(log))
    late = log.time > log.time[-1] - 0.5
    samples[late, list(RANGES).index("omega_fl")] *= 0.5
    samples[-5:, list(RANGES).index("a_x")] = 99.0
    return samples, Online(table, sample_time).run(samples)


def _vectors(samples: Array, told: Array, sample_time: float, width: Width) -> Iterator[str]:
    """vectors.h: every sample, and the answers at the ends of the blocks."""
    every = Timing.of(sample_time).samples
    kept = told[every - 1 :: every]
    yield f"/* Answers of Python to {len(samples)} samples, of each block of {every}. */"
    yield f"#define COUNT {len(samples)}U\n#define EVERY {every}U"
    yield f"#define TOLERANCE {_TOLERANCE[width.bits]:g}"
    for name, rows in (("inputs", samples), ("expected", kept)):
        cells = ",\n".join(", ".join(map(width.number, row)) for row in rows.tolist())
        yield f"static const bte_real {name}[] = {{\n{cells}\n}};"
    assert kept.shape[1] == OUTPUTS
