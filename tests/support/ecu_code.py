"""What tests the code of an ECU: sensors that fail, and programs for a PC and a bare Cortex-M4F."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

from calib.base.arrays import Array
from calib.ecu.native import OUTPUTS
from calib.estimation.online import CHANNELS, OMEGA
from calib.store.store import Store
from tests.support.programs import needs

SEDAN = Store(Path(__file__).parents[2] / "tables").load("sedan-2up")
RUN = Path(__file__).parents[1] / "ecu" / "run.c"
STRICT = "-pedantic -Wall -Wextra -Wconversion -Wdouble-promotion -Wshadow -Werror"
SAME_BITS = "-ffp-contract=off -fno-math-errno"
M4F = "arm-none-eabi-gcc -std=c99 -Os -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16"
CAR = "bte_car_sedan_2up"
LINK = f"--specs=rdimon.specs -Wl,--section-start=.vectors=0 bte.o {CAR}.o run.o -lm -o ecu.elf"
QEMU = (
    "qemu-system-arm -M mps2-an386 -icount shift=5 -nographic -monitor none -serial none "
    "-semihosting-config enable=on,target=native -kernel ecu.elf"
)
PER_TICK = 1.25  # instructions of 32 ns, as ``shift=5`` has them, in a tick of SysTick at 25 MHz
BOTH = [pytest.param(cc, marks=needs(cc)) for cc in ("gcc", "clang")]
NOTHING = (np.nan, np.inf, -np.inf, 1e30, 1e-40, 0.0)
READ = np.array([(channel.low, channel.high, *NOTHING) for channel in CHANNELS.values()])
"""What each channel may read once it fails (11, 8)."""


def program(code: Path, command: str, main: Path | None = None, car: str = "sedan_2up") -> Path:
    """A program by a compiler with its options: of the vectors, or of another ``main``."""
    out, last = code / "program", main or "-DBTE_VECTORS bte_run.c"
    called(code, command, SAME_BITS, f"-I. bte.c bte_car_{car}.c", last, "-lm -o", out)
    return out


def answers(code: Path, samples: Array, command: str | Path) -> Array:
    """Answers (n, 28) to samples (n, 11), in their floating point, of a program of `RUN`."""
    samples.tofile(code / "samples.bin")
    called(code, command)
    return np.fromfile(code / "answers.bin", samples.dtype).reshape(-1, OUTPUTS)


def on_target(code: Path, samples: Array) -> tuple[Array, list[int], Array]:
    """Run it over samples (n, 11) on the Cortex-M4F.

    Answers (n, 28); flash of bte.c and of bte_car.c, RAM of bte_state, stack of one bte_step
    [bytes]; instructions of each sample (n,).
    """
    called(code, M4F, SAME_BITS, STRICT, "-I. -c bte.c bte_car_sedan_2up.c", RUN)
    called(code, M4F, LINK)
    printed = answers(code, samples, QEMU)
    sizes = called(code, "arm-none-eabi-size bte.o bte_car_sedan_2up.o").splitlines()[1:]
    flash = [sum(map(int, size.split()[:2])) for size in sizes]  # text and data
    state, stack, *ticks = np.fromfile(code / "figures.bin", np.uint32).tolist()
    return printed, [*flash, state, stack], PER_TICK * np.array(ticks)


def links(command: str) -> bool:
    """Whether a compiler makes a program with its options here."""
    words = [*command.split(), "-x", "c", "-", "-o", os.devnull]
    process = subprocess.run(words, input=b"int main(void) { return 0; }", capture_output=True)
    return process.returncode == 0


def called(folder: Path, *command: str | Path) -> str:
    """What a program says; one that fails ends the test with it.

    The words of a command are parted at its spaces, those of a path are not.
    """
    words = [word for x in command for word in (x.split() if isinstance(x, str) else [str(x)])]
    process = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=60)
    assert process.returncode == 0, process.stdout[-1000:] + process.stderr[-2000:]
    return process.stdout + process.stderr


def failing(samples: Array, seed: int) -> Array:
    """Samples (n, 11) in pieces, each with gains and zeros that are wrong but go into the filter;
    some channels read an end of their range, or no number."""
    x, rng = samples.copy(), np.random.default_rng(seed)
    for part in np.split(x, np.sort(rng.integers(len(x), size=(5, 20, 100)[seed % 3]))):
        pressure, deceleration, wheels, front = np.exp(rng.normal(0.0, [1.0, 1.0, 0.5, 0.03]))
        part[:, :2] *= pressure, deceleration
        part[:, OMEGA] *= wheels * np.array([front, front, 1.0, 1.0])
        part[:, :6] += rng.normal(0.0, [1e5, 1.0, *(0.03,) * 4])
        fails = rng.random(len(CHANNELS)) < 0.02
        part[:, fails] = READ[fails, rng.integers(READ.shape[1])]
    return x
