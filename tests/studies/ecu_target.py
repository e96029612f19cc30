"""Measure the code of an ECU: flash, RAM, instructions on a Cortex-M4F, error to Python, MISRA.

    python tests/studies/ecu_target.py

Needs arm-none-eabi-gcc with newlib, qemu-system-arm, gcc, and cppcheck with its addon misra. QEMU
counts instructions, not cycles. A remark whose rule has no argument here ends the study with 1.
"""

import re
import shutil
import sys
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.ecu.code import write_code
from calib.ecu.native import Native
from calib.estimation.online import answered, samples_of
from calib.estimation.reasons import Reason
from calib.logs.read import read_log
from calib.store.store import Store
from calib.store.version import Stored
from calib.table.exported import Precision
from tests.studies.study import arguments
from tests.support.ecu_code import called, failing, on_target

ROOT = Path(__file__).parents[2]
FOLDERS = {
    "sedan-2up": "sedan",
    "sedan-sim": "simulation_study",
    "escort": "third_party",
}
"""Folder of sample logs by the table that was made of them."""
WIDTHS = {
    "float32, all rows": Precision(single=True),
    "float32, 12 points, 16 bits": Precision(12, 16),
    "double, all rows": Precision(),
}
ARGUED = {
    "2.4": "the enumerations have no tags; their constants are used",
    "11.3": "structures of numbers of one type, read as arrays of them",
    "12.1": "products before sums and comparisons before `&&`, as in the formulas of the paper; "
    "where it could be misread, gcc and clang remark with -Wall, and they do not",
    "12.3": "several variables or members of one kind in one declaration; no comma operator",
    "21.15": "the same, copied; and the bits of a number, for the sum",
    "20.10": "one `##`, which names a function of math.h for the floating point: sqrt or sqrtf",
}
"""Reasons to keep remarks, by rule of MISRA C:2012."""
ON_TARGET = ("ramp_wet_asphalt", "dry_asphalt_stop", "transition_dry_to_basalt")


def version(name: str) -> Stored:
    """Return a table of the repository's store."""
    return Store(ROOT / "tables").load(name)


def costs() -> None:
    """Print flash, RAM and instructions of runs on the Cortex-M4F."""
    print("| numbers | samples | flash bte.c | flash of the data | state | stack | mean | worst |")
    print("|---|---|---|---|---|---|---|---|")
    stored = version("sedan-2up")
    for width, how in WIDTHS.items():
        logs = [read_log(ROOT / "sample_logs" / "sedan" / f"{name}.csv") for name in ON_TARGET]
        runs = {log.name: samples_of(log) for log in logs}
        for seed in range(7) if how.single else ():
            runs[f"sensors fail, {seed}"] = failing(runs[logs[1].name], seed)
        for name, samples in runs.items():
            with TemporaryDirectory() as folder:
                write_code(stored, Path(folder, "code"), "ecu", how, logs[0].sample_time)
                inputs = samples.astype(f"f{how.floating // 8}")
                _, bytes_of, instructions = on_target(Path(folder, "code"), inputs)
            row = (*bytes_of, np.mean(instructions), np.max(instructions))
            print(
                f"| {width} | {name} |", " | ".join(f"{one:,.0f}" for one in row), "|", flush=True
            )


def from_python() -> None:
    """Print the largest relative errors of the code to Python, for each sample log."""
    print("\n| log | double | float32 | reasons that differ | samples |")
    print("|---|---|---|---|---|")
    for name, folder in FOLDERS.items():
        table = version(name).table
        for path in sorted((ROOT / "sample_logs" / folder).glob("*.[cp]*")):
            log = read_log(path)
            samples, step = samples_of(log), log.sample_time
            right = answered(table, step, samples)
            least = np.maximum(np.abs(right[:, 1:]), 1e-6)
            far, reasons = [], 0
            for how in (Precision(), Precision(single=True)):
                answers = Native(table, step, how).run(samples)
                far.append(float(np.max(np.abs(answers - right)[:, 1:] / least)))
                reasons += int(np.sum(answers[:, 0] != right[:, 0]))
            valid = int(np.sum(right[:, 0] == Reason.VALID))
            told_far = f"{far[0]:.1e} | {far[1]:.1e}"
            print(f"| {path.stem} | {told_far} | {reasons} | {len(right)}, {valid} valid |")


def remarks(code: Path) -> Counter[str]:
    """Count the remarks of cppcheck's addon misra about bte.c, by rule."""
    output = called(code, "cppcheck --addon=misra --std=c99 --quiet bte.c")
    return Counter(re.findall(r"\[misra-c2012-([\d.]+)\]", output))


def argued() -> bool:
    """Print the remarks by rule; return whether each rule has a reason to stay."""
    with TemporaryDirectory() as name:
        how = WIDTHS["float32, all rows"]
        write_code(version("sedan-2up"), Path(name, "code"), "ecu", how, 0.005)
        rules = remarks(Path(name, "code"))
    print("\n| rule | remarks | why they stay |\n|---|---|---|")
    for rule in sorted(rules, key=lambda rule: tuple(map(int, rule.split(".")))):
        print(f"| {rule} | {rules[rule]} | {ARGUED.get(rule, 'not argued')} |")
    return bool(rules) and rules.keys() <= ARGUED.keys()


def main() -> int:
    """Run the study."""
    arguments(__doc__)
    needed = ("arm-none-eabi-gcc", "qemu-system-arm", "gcc", "cppcheck")
    if missing := [tool for tool in needed if shutil.which(tool) is None]:
        print(f"missing here: {', '.join(missing)}", file=sys.stderr)
        return 1
    costs()
    from_python()
    return 0 if argued() else 1


if __name__ == "__main__":
    sys.exit(main())
