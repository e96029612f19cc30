"""The sample logs that the checks rest on, and what several checks have in common."""

import hashlib
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from calib.diagnosis.diagnose import Diagnosis, diagnose
from calib.fitting.fit import fit
from calib.logs.log import Log
from calib.logs.read import read_log
from calib.table.table import Table
from calib.validation.validate import Validation, validate

if TYPE_CHECKING:
    from calib.physics.vehicle import Vehicle

RAMPS = {"simulation_study": "ramp_noisy.parquet", "third_party": "cal_ramp.parquet"}
"""The folder of a car and its ramp."""
SEARCHED = {
    "hidden/case_0": ("ramp", "coast"),
    "hidden/case_2": ("ramp", "step_high"),
    "hidden/case_5": ("ramp", "coast"),
}
"""The folder of a hidden case and the two logs that are searched: enough to see its cause."""


class Material:
    """Logs below ``samples``, and work in the empty folder ``scratch``; made on first use."""

    def __init__(self, samples: Path, scratch: Path) -> None:
        self.samples, self.scratch = samples, scratch
        self._used: set[Path] = set()
        # one result each for as long as this object lives; an error is not kept
        self.log = cache(self._log)
        self.table = cache(self._table)
        self.stop = cache(self._stop)
        self.diagnosis = cache(self._diagnosis)

    def files(self) -> dict[str, str]:
        """SHA-256 [hex] of every sample file that was used so far, by path below ``samples``."""
        return {
            path.relative_to(self.samples).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(self._used)
        }

    def vehicle(self, file: str) -> "Vehicle":
        """The vehicle of a file below ``samples``."""
        from calib.physics.vehicle_file import read_vehicle

        return read_vehicle(self._file(file))

    def _file(self, file: str) -> Path:
        path = self.samples / file
        self._used.add(path)
        return path

    def _log(self, file: str) -> Log:
        return read_log(self._file(file))

    def _table(self, folder: str) -> Table:
        """The table of the car in ``folder``, fitted from its ramp alone."""
        return fit(self.vehicle(f"{folder}/vehicle.toml"), [self.log(f"{folder}/{RAMPS[folder]}")])

    def _stop(self, folder: str, stop: str, vehicle: str = "vehicle.toml") -> Validation:
        """The validation of one hold-out with the table of its folder."""
        told = self.vehicle(f"{folder}/{vehicle}")
        return validate(self.table(folder), [self.log(f"{folder}/{stop}")], told)[0]

    def _diagnosis(self, case: str) -> Diagnosis:
        """The diagnosis of a hidden case from two logs and one hold-out."""
        searched = [self.log(f"{case}/calibration/{name}.parquet") for name in SEARCHED[case]]
        held = self.log(f"{case}/holdout/stop_a.parquet")
        return diagnose(self.vehicle(f"{case}/vehicle.toml"), searched, [held])
