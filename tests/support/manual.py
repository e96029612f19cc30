"""The examples of the manual: blocks of code of a page, and a folder in which they run."""

import re
import shlex
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from calib.help.samples import sample_logs
from tests.support.command import typed
from tests.support.tyre_files import written

FOLDER = Path(__file__).parents[2] / "calib" / "manual"
PAGES = sorted(FOLDER.glob("*.md"))

LANGUAGES = ("sh", "powershell", "python", "toml", "json", "text")
"""Of a block of code; text is output or a drawing, and nobody runs or reads it, nor PowerShell."""

_BLOCK = re.compile(
    r"(?:<!-- (?P<mark>[^\n]*?) -->\n)?```(?P<head>[^\n]*)\n(?P<text>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)


@dataclass(frozen=True)
class Example:
    """A block: ``language``, ``kind`` of the file it shows, ``text``, and the comment before it."""

    language: str
    kind: str
    text: str
    mark: str

    @property
    def is_run(self) -> bool:
        return self.language in ("sh", "python") and not self.mark.startswith("not run: ")

    @property
    def ends_with(self) -> int:
        """Exit code that its last command must have."""
        match = re.fullmatch(r"exit code (\d)", self.mark)
        return int(match[1]) if match else 0

    @property
    def commands(self) -> list[str]:
        """The lines of a shell, continued ones joined."""
        return self.text.replace("\\\n", " ").splitlines()


def examples(page: Path) -> Iterator[Example]:
    """The blocks of a page, in their order."""
    for found in _BLOCK.finditer(page.read_text(encoding="utf-8")):
        language, _, kind = found["head"].partition(" ")
        yield Example(language, kind, found["text"], found["mark"] or "")


def run(folder: Path, line: str) -> int:
    """Run one printed line in a folder as a shell would: globs filled, options split."""
    words = shlex.split(line)
    assert words[0] == "brake-cal"
    arguments = []
    for word, as_typed in zip(words[1:], shlex.split(line, posix=False)[1:], strict=True):
        quoted = as_typed.startswith(("'", '"'))
        paths = sorted(str(p.relative_to(folder)) for p in folder.glob(word)) if "*" in word else []
        arguments += paths if paths and not quoted else [word]
    return typed(*arguments, folder=folder)


LOGS = {
    "ramp.csv": "ramp_wet_asphalt.csv",
    "coast.csv": "coast.csv",
    "stop.csv": "basalt_wet_pads.csv",
    "stop_1.csv": "dry_asphalt_stop.csv",
    "stop_2.csv": "transition_dry_to_basalt.csv",
}

OWN = {
    "my_ramp.csv": "ramp_wet_asphalt.csv",
    "my_coast.csv": "coast.csv",
    "my_stop.csv": "basalt_wet_pads.csv",
}
"""Logs of the same runs by another program."""

FOREIGN = {
    "time [s]": ("Time [ms]", 1e3),
    "p_mc [bar]": ("BrkPress [kPa]", 1e2),
    "a_x [m/s^2]": ("Decel [g]", -1.0 / 9.80665),
    "omega_fl [rad/s]": ("WhlSpdFL [rpm]", 30.0 / np.pi),
    "omega_fr [rad/s]": ("WhlSpdFR [rpm]", 30.0 / np.pi),
    "omega_rl [rad/s]": ("WhlSpdRL [rpm]", 30.0 / np.pi),
    "omega_rr [rad/s]": ("WhlSpdRR [rpm]", 30.0 / np.pi),
    "v [m/s]": ("GPS_Speed [km/h]", 3.6),
}
"""Its name and unit of each channel, and its number for 1 of ours."""


MODEL = """schema = 1

[effects.aerodynamic_drag]
drag_area = "0.66 m^2"
"""

BENCH = """schema = 1
[front]
p_mc = ["10 bar", "20 bar", "30 bar"]
brake_force = ["1.75 kN", "3.53 kN", "5.31 kN"]
[rear]
p_mc = ["10 bar", "20 bar", "30 bar"]
brake_force = ["62 daN", "128 daN", "194 daN"]
"""


def working_folder(folder: Path) -> None:
    """What the examples begin with: logs, vehicles, a table `car@1`, and results of one stop."""
    (folder / "sample_logs").symlink_to(sample_logs())
    for name, source in LOGS.items():
        shutil.copy(sample_logs() / "sedan" / source, folder / name)
    for name, source in OWN.items():
        frame = pd.read_csv(sample_logs() / "sedan" / source)
        columns = {theirs: frame[ours] * scale for ours, (theirs, scale) in FOREIGN.items()}
        pd.DataFrame(columns).to_csv(folder / name, index=False, float_format="%.7g")
    vehicle = (sample_logs() / "sedan" / "vehicle.toml").read_text()
    (folder / "car.toml").write_text(vehicle.replace("sedan-2up", "car"))
    weighed = vehicle.replace("[chassis]", "[chassis]\nmass_tolerance = 0.005\nmotor_odds = 0")
    (folder / "my_car.toml").write_text(weighed.replace("sedan-2up", "my_car"))
    (folder / "bench.toml").write_text(BENCH)
    written(folder / "tyre.tir")
    (folder / "found").mkdir()
    (folder / "found" / "model.toml").write_text(MODEL)
    assert run(folder, "brake-cal fit ramp.csv coast.csv --vehicle car.toml") == 0
    assert run(folder, "brake-cal validate car stop.csv --out results") == 0
