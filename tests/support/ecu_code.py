"""The code of a table as programs: of this machine, and of a bare Cortex-M4F that QEMU runs."""

import re
import subprocess
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from calib.base.arrays import Array
from calib.ecu.native import OUTPUTS, write_sources
from calib.table.exported import Precision
from calib.table.table import Table

TARGET = Path(__file__).parents[1] / "ecu" / "target"

STRICT = [
    *("-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Wsign-conversion", "-Wshadow"),
    *("-Werror", "-pedantic"),
]
SAME_BITS = ["-ffp-contract=off", "-fno-math-errno"]
M4F = [
    *("arm-none-eabi-gcc", "-std=c99", "-Os", "-ffunction-sections", "-fdata-sections"),
    *("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"),
]
LINK = ["--specs=rdimon.specs", "-Wl,--gc-sections", "-T", TARGET / "link.ld"]
QEMU = [
    *("qemu-system-arm", "-M", "mps2-an386", "-icount", "shift=5", "-nographic"),
    *("-semihosting-config", "enable=on,target=native", "-monitor", "none", "-serial", "none"),
]
PER_TICK = 1.25
"""Instructions of 32 ns, which ``shift=5`` makes them, in a tick of SysTick at 25 MHz."""

ARGUED = {
    "2.4": "the enumerations have no tags; their constants are used",
    "8.7": "functions of the interface, which an ECU calls from its own files",
    "10.4": "places in an array that are an enumeration and a number; reasons in one expression",
    "12.1": "products before sums and comparisons before `&&`, as in the formulas of the paper; "
    "where it could be misread, gcc and clang remark with -Wall, and they do not",
    "12.3": "several variables or members of one kind in one declaration; no comma operator",
    "21.15": "the bits of a floating-point number, in the way that C defines: memcpy",
}
"""Why the remarks of a rule of MISRA C:2012 stay."""


@dataclass(frozen=True)
class OnTarget:
    """What a run on the Cortex-M4F answered, and what it took."""

    answers: Array  # (n, 22)
    code: int  # flash of bte.c [bytes]
    numbers: int  # flash of bte_car.c [bytes]
    state: int  # RAM of bte_state [bytes]
    stack: int  # of one bte_step [bytes]
    mean: float  # instructions of a sample
    worst: float


@dataclass(frozen=True)
class Code:
    """A folder with the code of a table, and the files of a program besides its own."""

    folder: Path
    how: Precision
    sources: list[Path]

    @classmethod
    def of(cls, table: Table, sample_time: float, how: Precision, folder: Path) -> "Code":
        """Write it."""
        return cls(folder, how, write_sources(table, sample_time, how, folder))

    @property
    def real(self) -> type[np.floating]:
        """Its floating point."""
        return np.float64 if self.how.floating == 64 else np.float32

    def program(self, *command: str) -> Path:
        """One of this machine; ``command`` a compiler with its options."""
        out = self.folder / "_".join(["host", *command]).replace("=", "").replace(",", "_")
        files = [*self.sources, TARGET / "run.c"]
        called(*command, "-std=c99", *SAME_BITS, f"-I{self.folder}", *files, "-lm", "-o", out)
        return out

    def answers(self, samples: Array, *command: object) -> Array:
        """Answers (n, 22) of a program to samples (n, 10)."""
        samples.astype(self.real).tofile(self.folder / "samples.bin")
        called(*command, folder=self.folder)
        return np.fromfile(self.folder / "answers.bin", self.real).reshape(-1, OUTPUTS)

    def on_target(self, samples: Array) -> OnTarget:
        """Build it for the Cortex-M4F, and run it there over samples (n, 10)."""
        compiler, objects = [*M4F, *SAME_BITS, *STRICT, f"-I{self.folder}"], []
        for source in (*self.sources, TARGET / "run.c"):
            objects.append(self.folder / f"{source.stem}.o")
            called(*compiler, "-c", source, "-o", objects[-1])
        called(*compiler, *LINK, *objects, "-lm", "-o", self.folder / "ecu.elf")
        answers = self.answers(samples, *QEMU, "-kernel", "ecu.elf")
        figures = np.fromfile(self.folder / "figures.bin", np.uint32).tolist()
        state, stack, count, ticks, worst = figures
        size = {one.stem: flash(one) for one in objects}
        instructions = PER_TICK * ticks / count, PER_TICK * worst
        return OnTarget(answers, size["bte"], size["bte_car"], state, stack, *instructions)

    def remarks(self) -> Counter[str]:
        """Remarks of cppcheck's addon misra about bte.c, by rule."""
        command = ["cppcheck", "--addon=misra", "--std=c99", "--quiet", "bte.c"]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, check=True)
        return Counter(re.findall(r"\[misra-c2012-([\d.]+)\]", done.stderr))


def called(*command: object, folder: Path | None = None) -> str:
    """What a program prints; one that fails ends the test with what it says."""
    words = list(map(str, command))
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


def flash(made: Path) -> int:
    """Bytes of code and of constants in an object file."""
    rows = map(str.split, called("arm-none-eabi-size", "-A", made).splitlines())
    kept = (".text", ".rodata", ".data")
    return sum(int(row[1]) for row in rows if len(row) == 3 and row[0].startswith(kept))
