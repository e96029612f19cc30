"""The code of an ECU on a Cortex-M4F: flash, RAM, instructions; its distance from Python; MISRA.

    python tests/studies/ecu_target.py

Needs arm-none-eabi-gcc with newlib, qemu-system-arm, gcc, and cppcheck with its addon misra. QEMU
counts instructions, not cycles. A remark whose rule has no argument here ends the study with 1.
"""

import shutil
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.ecu.channels import samples_of
from calib.ecu.native import Native
from calib.ecu.online import Online
from calib.estimation.reasons import Reason
from calib.logs.read import read_log
from calib.store.store import Store
from calib.table.exported import Precision
from calib.table.table import Table
from tests.studies.study import arguments
from tests.support.ecu_code import ARGUED, M4F, Code
from tests.support.failing_sensors import WAYS, failing

ROOT = Path(__file__).parents[2]
FOLDERS = {
    "sedan-2up": "sedan",
    "sedan-sim": "simulation_study",
    "escort": "third_party",
}
"""The table of each folder of sample logs."""
WIDTHS = {
    "float32, all rows": Precision(single=True),
    "float32, 12 points, 16 bits": Precision(12, 16),
    "double, all rows": Precision(),
}
ON_TARGET = ("ramp_wet_asphalt", "dry_asphalt_stop", "transition_dry_to_basalt")


def table_of(name: str) -> Table:
    """A table of the repository's store."""
    return Store(ROOT / "tables").load(name).table


def on_target() -> None:
    """Print what runs on the Cortex-M4F took."""
    print("| numbers | samples | flash bte.c | flash bte_car.c | state | stack | mean | worst |")
    print("|---|---|---|---|---|---|---|---|")
    table = table_of("sedan-2up")
    for told, how in WIDTHS.items():
        logs = [read_log(ROOT / "sample_logs" / "sedan" / f"{name}.csv") for name in ON_TARGET]
        given = {log.name: samples_of(log) for log in logs}
        for seed, way in enumerate(WAYS) if how.single else ():
            name = f"sensors fail: {way.__name__.replace('_', ' ')}"
            given[name] = failing(given[logs[1].name], seed)
        for name, samples in given.items():
            with TemporaryDirectory() as folder:
                code = Code.of(table, logs[0].sample_time, how, Path(folder))
                x = code.on_target(samples)
            row = (x.code, x.numbers, x.state, x.stack, x.mean, x.worst)
            print(f"| {told} | {name} |", " | ".join(f"{one:,.0f}" for one in row), "|", flush=True)


def from_python() -> None:
    """Print how far the code is from Python, over all samples of all sample logs."""
    print("\n| log | double | float32 | reasons that differ | samples |")
    print("|---|---|---|---|---|")
    for name, folder in FOLDERS.items():
        table = table_of(name)
        for path in sorted((ROOT / "sample_logs" / folder).glob("*.[cp]*")):
            log = read_log(path)
            samples, step = samples_of(log), log.sample_time
            right = Online(table, step).run(samples)
            least = np.maximum(np.abs(right[:, 1:]), 1e-6)
            far, reasons = [], 0
            for how in (Precision(), Precision()):
                told = Native(table, step, how).run(samples)
                far.append(float(np.max(np.abs(told - right)[:, 1:] / least)))
                reasons += int(np.sum(told[:, 0] != right[:, 0]))
            valid = int(np.sum(right[:, 0] == Reason.VALID))
            told_far = f"{far[0]:.1e} | {far[1]:.1e}"
            print(f"| {path.stem} | {told_far} | {reasons} | {len(right)}, {valid} valid |")


def remarks() -> bool:
    """Print the remarks of cppcheck by rule; whether each rule has an argument."""
    with TemporaryDirectory() as name:
        how = WIDTHS["float32, all rows"]
        rules = Code.of(table_of("sedan-2up"), 0.005, how, Path(name)).remarks()
    print("\n| rule | remarks | why they stay |\n|---|---|---|")
    for rule in sorted(rules, key=lambda rule: tuple(map(int, rule.split(".")))):
        print(f"| {rule} | {rules[rule]} | {ARGUED.get(rule, 'not argued')} |")
    return bool(rules) and rules.keys() <= ARGUED.keys()


def main() -> int:
    """Run the study."""
    arguments(__doc__)
    needed = (M4F[0], "qemu-system-arm", "gcc", "cppcheck")
    if missing := [tool for tool in needed if shutil.which(tool) is None]:
        print(f"missing here: {', '.join(missing)}", file=sys.stderr)
        return 1
    on_target()
    from_python()
    return 0 if remarks() else 1


if __name__ == "__main__":
    sys.exit(main())
