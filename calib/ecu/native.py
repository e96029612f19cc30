"""The C code of an ECU, compiled for this machine and run on logs.

bte.c + bte_car_here.c --cc--> shared object --ctypes--> answers of every sample
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
from calib.ecu.car_source import SOURCE
from calib.estimation.estimator import Estimate
from calib.estimation.known import require_plain
from calib.estimation.online import ANSWERS, READ_OUT, rows_of, samples_of
from calib.estimation.readout import Bounded, Readout
from calib.estimation.validate import Coded
from calib.logs.log import Log
from calib.table.exported import Precision
from calib.table.table import Table

OUTPUTS = 1 + 3 * len(ANSWERS)  # a reason, and `ANSWERS` with their bounds

_FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-shared")
"""Without contraction every compiler gives the same bits."""


def compiler() -> list[str]:
    """The C compiler with its options: $CC, else cc. Raises ProgramError where there is none."""
    named = shlex.split(os.environ.get("CC") or "cc")
    if shutil.which(named[0]) is None:
        raise ProgramError(
            "no C compiler",
            where=named[0],
            expected="cc on PATH, or CC",
            do="install gcc or clang: `apt install gcc`, `xcode-select --install`, or MSYS2",
        )
    return named


class Native:
    """The code of a table at a sample time [s], in a precision: its shared ``library``.

    Raises ProgramError where it cannot be compiled.
    """

    def __init__(self, table: Table, sample_time: float, how: Precision) -> None:
        cc, self.real = compiler(), np.float64 if how.floating == 64 else np.float32
        files = sources(table, sample_time, how, "here")
        files["bte_run.c"] = (SOURCE / "bte_run.c").read_text(encoding="utf-8")
        with TemporaryDirectory() as folder:
            for name, text in files.items():
                Path(folder, name).write_text(text, encoding="utf-8")
            library = str(Path(folder, "bte.so"))
            code = [str(Path(folder, name)) for name in files if name.endswith(".c")]
            line = [*cc, *_FLAGS, *code, "-o", library, "-lm"]
            ran = subprocess.run(line, capture_output=True, text=True, check=False)
            if not Path(library).exists():
                why = f"exit code {ran.returncode}: {ran.stderr[:400]}"
                raise ProgramError("the C code does not compile", where=cc[0], do=why)
            self.library = ctypes.CDLL(library)

    def run(self, samples: Array) -> Array:
        """Answers (n, 28) to samples (n, 11), as `bte_run` has them."""
        inputs = np.ascontiguousarray(samples, self.real)
        rows = np.empty((len(inputs), OUTPUTS), self.real)
        first, last = (ctypes.c_void_p(x.ctypes.data) for x in (inputs, rows))
        car = ctypes.byref(ctypes.c_char.in_dll(self.library, "bte_car_here"))
        self.library.bte_run(car, first, ctypes.c_uint32(len(inputs)), last)
        return rows.astype(np.float64)


def coded(table: Table, how: Precision) -> Coded:
    """Return a function that runs the exported code of a table on logs of any rate and mass.

    It replaces ``ecu`` of an estimate, but for the change since the ramp, which C does not have.
    Raises ProgramError where there is no compiler, StoreError for a table that has no code.
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
