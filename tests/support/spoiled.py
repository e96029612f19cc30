"""Logs that are spoiled at random, and what the program says of them.

What must hold of each: no exception but a BrakeCalError, and no number that is not finite in a
result, a document, a warning or a message.
"""

import io
import json
import re
import sys
import tempfile
import traceback
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array
from calib.base.errors import BrakeCalError, LogError, NotFiniteError, VehicleError
from calib.base.names import CHANNELS
from calib.base.units import from_si
from calib.base.warning import RULES
from calib.diagnosis.runs import checked
from calib.estimation.validate import validate
from calib.fitting.fit import fit
from calib.logs.log import Log
from calib.logs.read import read_log
from calib.plausibility.check import check, to_dict
from calib.table.table import Table
from cli.console import json_text
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, noisy, ramp, stop

Spoil = Callable[[np.random.Generator, Array], Array]

NOT_A_NUMBER = re.compile(r"(?<![A-Za-z_])(nan|inf|NaN|Infinity)(?![A-Za-z_])")


def _some(rng: np.random.Generator, x: Array) -> NDArray[np.bool_]:
    """A sample, a short part, a long part or single samples of a channel (n,)."""
    place, kind = int(rng.integers(x.size)), rng.integers(4)
    if kind == 3:
        return rng.random(x.size) < 10.0 ** rng.uniform(-3.0, -0.3)
    length = (1, int(rng.integers(2, 30)), int(rng.integers(30, x.size + 31)))[kind]
    mask = np.zeros(x.size, bool)
    mask[place : place + length] = True
    return mask


def _put(values: tuple[float, ...]) -> Spoil:
    return lambda rng, x: np.where(_some(rng, x), rng.choice(values), x)


SPOILS: dict[str, Spoil] = {
    "nan": _put((np.nan,)),
    "inf": _put((np.inf, -np.inf)),
    "zeros": _put((0.0,)),
    "type end": _put((65535.0, 655.35, 327.675, -32768.0, 255.0, 3.4e38)),
    "held": lambda rng, x: x[np.minimum(np.arange(x.size) // int(rng.integers(2, 60)), x.size - 1)],
    "constant": lambda rng, x: np.full_like(x, rng.choice([0.0, x[0], x.max()])),
    "step": lambda rng, x: np.where(np.arange(x.size) > rng.integers(x.size), x + x.max(), x),
    "scaled": lambda rng, x: x * rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-3.0, 3.0),
    "shifted": lambda rng, x: x + rng.normal() * np.ptp(x),
    "late": lambda rng, x: np.roll(x, int(rng.integers(-200, 200))),
    "noise": lambda rng, x: x + rng.normal(size=x.size) * np.ptp(x) * 10.0 ** rng.uniform(-4, 0),
    "coarse": lambda rng, x: np.round(x / max(np.ptp(x), 1e-9) * 5.0) * np.ptp(x) / 5.0,
}


@np.errstate(all="ignore")  # spoils of spoils
def spoiled(log: Log, rng: np.random.Generator) -> tuple[str, str]:
    """What was done, and the log as CSV with one to three channels spoiled, rows cut or columns
    swapped."""
    columns = {
        name: from_si(x, CHANNELS[name].unit, CHANNELS[name].si) for name, x in log.channels.items()
    }
    changes = []
    for _ in range(int(rng.integers(1, 4))):
        kind = str(rng.choice([*SPOILS, "swapped", "cut"]))
        name = str(rng.choice([n for n in columns if n != "time" or rng.random() < 0.3]))
        changes.append(f"{name} {kind}")
        if kind == "swapped":
            other = str(rng.choice([*columns]))
            columns[name], columns[other] = columns[other], columns[name]
        elif kind == "cut":
            first, last = sorted(rng.integers(0, columns[name].size + 1, 2))
            columns = {n: x[first:last] if last - first > 5 else x for n, x in columns.items()}
        else:
            columns[name] = SPOILS[kind](rng, columns[name])
    text = io.StringIO()
    head = ",".join(f"{name} [{CHANNELS[name].unit}]" for name in columns)
    np.savetxt(text, np.column_stack([*columns.values()]), "%.9g", ",", header=head, comments="")
    return ", ".join(changes), text.getvalue()


OTHERS = [noisy(ramp(REAL, name="other ramp"), 11), noisy(stop(REAL, 30e5, "other stop"), 12)]
HELD = [noisy(stop(REAL, 35e5, "hold-out"), 13)]
NEEDS_MORE = {rule.code for rule in RULES if rule.needs}
"""Codes of rules that need more than the log: a vehicle, other logs, the table."""


def disagreements(log: Log, table: Table) -> list[str]:
    """Where `check` says another thing of a log than the uses themselves.

    They may know more: their vehicle, the other logs, the table.
    """
    log_check = check(log)
    coasts = not log_check.run.events
    with_ramp = [log, OTHERS[0]] if coasts else [log]
    uses: dict[str, Callable[[], object]] = {
        "coast" if coasts else "fit": lambda: fit(CAR, with_ramp),
        "validate": lambda: _of_use(table, log),
        "diagnose": lambda: checked(CAR, [log, *OTHERS], HELD),
    }
    usable = {one.purpose: one.usable for one in log_check.verdicts}
    return [
        f"{use}: check says {usable[use]}, and it is {why or 'used'}"
        for use, act in uses.items()
        if (why := _refused(act, usable[use])) is not None
    ]


def _of_use(table: Table, log: Log) -> None:
    (result,) = validate(table, [log])
    if result.estimate.unfit:
        raise LogError(str(result.warnings))


def _refused(act: Callable[[], object], usable: bool) -> str | None:
    """What a use says against a log that `check` takes for usable or not; None if they agree."""
    try:
        act()
    except VehicleError:
        return None
    except LogError as error:
        more = set(re.findall(r"\w+", str(error))) & NEEDS_MORE
        return str(error) if usable and not more else None
    return None if usable else ""


def findings(text: str, table: Table, ramp: bool) -> list[str]:
    """What is wrong in how check, then fit or validate, take a log as CSV; and `disagreements`."""
    works = (_checked, _fitted if ramp else partial(_validated, table))
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("error")
        path = Path(folder) / "spoiled.csv"
        path.write_text(text)
        flaws = [flaw for work in works for flaw in _flaws(work, path)]
        try:
            return flaws + disagreements(read_log(path), table)
        except LogError:
            return flaws


def _flaws(work: Callable[[Path], list[str]], path: Path) -> list[str]:
    try:
        texts = work(path)
    except NotFiniteError as error:
        return [f"not finite: {error.problem}"]
    except BrakeCalError as error:
        texts = [str(error)]
    except Exception as error:
        return traceback.format_exception(error)[-2:]
    matches = [(text, NOT_A_NUMBER.search(text)) for text in texts]
    return [repr(text[max(0, at.start() - 60) : at.end() + 30]) for text, at in matches if at]


def _checked(path: Path) -> list[str]:
    log_check = check(read_log(path, require=()))
    return [repr(log_check), json_text(to_dict(log_check)), *map(str, log_check.warnings)]


def _fitted(path: Path) -> list[str]:
    table = fit(CAR, [read_log(path)])
    content = json.dumps(table.content()[0])
    return [repr(table), content, *map(str, table.warnings), *table.remarks]


def _validated(table: Table, path: Path) -> list[str]:
    (result,) = validate(table, [read_log(path)])
    return [repr(result), json.dumps(result.figures), *map(str, result.warnings)]


def main(count: int) -> None:
    """Spoil logs, and print each flaw and each disagreement."""
    coast = as_log(drive(REAL, lambda t: 0.0, 33.0, duration=8.0), "coast")
    runs = [noisy(log, i) for i, log in enumerate((ramp(REAL), stop(REAL), coast))]
    table = fit(CAR, [runs[0]])
    for number in range(count):
        changes, text = spoiled(runs[number % 3], np.random.default_rng([1, number]))
        for flaw in findings(text, table, number % 3 == 0):
            sys.stdout.write(f"{number} {changes}\n      {flaw}\n")


if __name__ == "__main__":
    main(int(sys.argv[1]))
