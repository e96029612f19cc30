"""The code of a table as programs: of this machine, and of a bare Cortex-M4F that QEMU runs."""

import subprocess
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

import numpy as np

from calib.base.arrays import Array
from calib.ecu.native import OUTPUTS, SOURCE, write_sources
from calib.ecu.width import Width
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
LINK = ["-Wl,--gc-sections", "-nostartfiles", "-T", str(TARGET / "link.ld")]
QEMU = [
    *("qemu-system-arm", "-M", "mps2-an386", "-icount", "shift=5"),
    *("-semihosting-config", "enable=on,target=native"),
    *("-nographic", "-monitor", "none", "-serial", "none"),
]
PER_TICK = 1.25
"""Instructions of 32 ns, which ``shift=5`` makes them, in a tick of SysTick at 25 MHz."""


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

    @property
    def ram(self) -> int:
        """All RAM that one estimator needs [bytes]."""
        return self.state + self.stack


@dataclass(frozen=True)
class Code:
    """A folder with bte_config.h and bte_car.c of a table; all other files are those of any car."""

    folder: Path
    width: Width
    sources: list[Path]  # of a program, besides its own

    @classmethod
    def of(cls, table: Table, sample_time: float, width: Width, folder: Path) -> "Code":
        """Write it."""
        return cls(folder, width, write_sources(table, sample_time, width, folder))

    @property
    def include(self) -> list[str]:
        """Where its headers are."""
        return [f"-I{folder}" for folder in (self.folder, SOURCE, TARGET)]

    @property
    def real(self) -> type[np.floating]:
        """Its floating point."""
        return np.float64 if self.width.bits == 64 else np.float32

    def program(self, *command: str) -> Path:
        """One of this machine; ``command`` a compiler with its options."""
        out = self.folder / "_".join(["host", *command]).replace("=", "").replace(",", "_")
        files = [*self.sources, TARGET / "host.c"]
        called(*command, "-std=c99", *SAME_BITS, *self.include, *files, "-lm", "-o", out)
        return out

    def answers(self, program: Path, samples: Array) -> Array:
        """Answers (n, 22) of a `program` to samples (n, 10)."""
        given = np.ascontiguousarray(samples, self.real)
        told = called(program, len(given), given=given.tobytes())
        return np.frombuffer(told, self.real).reshape(-1, OUTPUTS)

    def on_target(self, samples: Array) -> OnTarget:
        """Build it for the Cortex-M4F, and run it there over samples (n, 10)."""
        rows = ",\n".join(", ".join(map(self.width.number, row)) for row in samples.tolist())
        text = f"#define COUNT {len(samples)}U\nstatic const bte_real samples[] = {{\n{rows}\n}};\n"
        (self.folder / "samples.h").write_text(text)
        command = [*M4F, *SAME_BITS, *STRICT, *self.include]
        objects = []
        for source in (*self.sources, TARGET / "start.c", TARGET / "measure.c"):
            objects.append(self.folder / f"{source.stem}.o")
            called(*command, "-c", source, "-o", objects[-1])
        called(*command, *LINK, *objects, "-lm", "-o", self.folder / "ecu.elf")
        called(*QEMU, "-kernel", "ecu.elf", folder=self.folder)
        figures = np.fromfile(self.folder / "figures.bin", np.uint32).tolist()
        state, stack, count, ticks, worst, _ = figures
        return OnTarget(
            np.fromfile(self.folder / "answers.bin", self.real).reshape(-1, OUTPUTS),
            *map(flash, (objects[0], objects[2])),
            state, stack, PER_TICK * ticks / count, PER_TICK * worst,
        )  # fmt: skip


def called(*command: object, given: bytes = b"", folder: Path | None = None) -> bytes:
    """What a program prints; one that fails ends the test with what it says."""
    done = subprocess.run(
        list(map(str, command)), input=given, cwd=folder, capture_output=True, timeout=60
    )
    assert done.returncode == 0, done.stderr.decode()[-2000:]
    return done.stdout


def flash(made: Path) -> int:
    """Bytes of code and of constants in an object file."""
    rows = map(str.split, called("arm-none-eabi-size", "-A", made).decode().splitlines())
    kept = (".text", ".rodata", ".data")
    return sum(int(row[1]) for row in rows if len(row) == 3 and row[0].startswith(kept))


def bits(answers: Array) -> str:
    """A hash of the bits of answers."""
    return sha256(answers.tobytes()).hexdigest()
