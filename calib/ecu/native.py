"""The C code of an ECU, compiled for this machine and run on logs.

bte.h, bte.c, bte_car_here.c, bte_run.c --cc--> shared library --ctypes--> answers of a log
"""

import ctypes
import os
import shlex
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ProgramError
from calib.ecu.car_data import sources
from calib.ecu.structures import source
from calib.estimation.estimator import Estimate
from calib.estimation.known import require_plain
from calib.estimation.online import ANSWERS, READ_OUT, rows_of, samples_of
from calib.estimation.readout import Bounded, Readout
from calib.estimation.validate import Coded
from calib.logs.log import Log
from calib.store.version import as_version
from calib.table.exported import Precision
from calib.table.table import Table

OUTPUTS = 1 + 3 * len(ANSWERS)  # a reason, and `ANSWERS` with their bounds
_FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-shared")
# without contraction every compiler gives the same bits
_INSTALL = "install gcc or clang: `apt install gcc`, `xcode-select --install`, or MSYS2"


def compiler() -> list[str]:
    """Return the C compiler with its options: $CC, else cc. Raises ProgramError without one."""
    words = shlex.split(os.environ.get("CC") or "cc")
    if shutil.which(words[0]) is None:
        raise ProgramError("no C compiler", where=words[0], expected="cc or $CC", do=_INSTALL)
    return words


class Native:
    """The code of a table at a sample time [s], as a shared ``library``. Raises ProgramError."""

    def __init__(self, table: Table, sample_time: float, how: Precision) -> None:
        self.real = np.dtype(f"f{how.floating // 8}")
        cc, files = compiler(), sources(as_version(table), sample_time, how, "here")
        files["bte_run.c"] = source("bte_run.c")
        with TemporaryDirectory() as folder:
            for name, text in files.items():
                Path(folder, name).write_text(text, encoding="utf-8")
            library = Path(folder, "bte.so")
            code = map(str, Path(folder).glob("*.c"))
            line = [*cc, *_FLAGS, *code, "-o", str(library), "-lm"]
            ran = subprocess.run(line, capture_output=True, text=True, check=False)
            if not library.exists():
                why = f"exit code {ran.returncode}: {ran.stderr[:400]}"
                raise ProgramError("the C code does not compile", where=cc[0], do=why)
            self.library = ctypes.CDLL(str(library))

    def run(self, samples: Array) -> Array:
        """Return reasons and answers (n, OUTPUTS) of `bte_run` to samples (n, 11)."""
        inputs = np.ascontiguousarray(samples, self.real)
        rows = np.empty((len(inputs), OUTPUTS), self.real)
        first_input, first_answer = (ctypes.c_void_p(x.ctypes.data) for x in (inputs, rows))
        car = ctypes.byref(ctypes.c_char.in_dll(self.library, "bte_car_here"))
        self.library.bte_run(car, first_input, ctypes.c_uint32(len(inputs)), first_answer)
        return rows.astype(np.float64)


def coded(table: Table, how: Precision) -> Coded:
    """Return a function that runs the exported code of a table on logs of any rate and mass.

    Its answers replace those of ``ecu`` in an estimate, except `pad_change`, which C lacks. Raises
    ProgramError without a compiler, StoreError for a table that has no code.
    """
    compiler()
    require_plain(table)
    codes = dict[tuple[float, float], Native]()

    def run(e: Estimate, log: Log) -> Readout:
        require_plain(replace(e.table, vehicle=e.car))
        key = e.table.vehicle.mass, log.sample_time
        if key not in codes:
            codes[key] = Native(e.table, log.sample_time, how)
        reason, *columns = codes[key].run(samples_of(log))[rows_of(log)].T
        answers = map(Bounded, columns[::3], columns[1::3], columns[2::3])
        parts: dict[str, Any] = dict(zip(READ_OUT, answers, strict=True))
        return replace(e.ecu, step=e.ecu.step._replace(reason=reason), **parts)

    return run
