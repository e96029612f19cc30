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


DAMAGED = "cut_in_half.parquet"
"""The damaged log of a batch."""


class Material:
    """Logs below ``samples``, and work in the empty folder ``scratch``; made on first use."""

    def __init__(self, samples: Path, scratch: Path) -> None:
        self.samples, self.scratch = samples, scratch
        self._used: set[Path] = set()
        # one result each for as long as this object lives; an error is not kept
        self.log = cache(self._log)
        self.table = cache(self._table)
        self.stop = cache(self._stop)
        self.batch = cache(self._batch)
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

    def _batch(self, folder: str, stops: tuple[str, ...]) -> dict[str, tuple[str, float]]:
        """Status and front pad friction by log, from the results of `batch validate`.

        The first of ``stops`` is also there cut in half, as `DAMAGED`.
        """
        import pyarrow.parquet as pq

        from calib.fleet.command import Command
        from calib.fleet.job import Job
        from calib.fleet.pool import Pool
        from calib.fleet.run import run_batch

        logs = self.scratch / "batch"
        logs.mkdir()
        for stop in stops:
            (logs / stop).write_bytes(self._file(f"{folder}/{stop}").read_bytes())
        whole = (logs / stops[0]).read_bytes()
        (logs / DAMAGED).write_bytes(whole[: len(whole) // 2])
        pool = Pool(2)
        try:
            job = Job(Command.VALIDATE, self.table(folder))
            found = run_batch(job, [str(logs)], self.scratch / "results", pool)
        finally:
            pool.close()
        rows = pq.read_table(found.results, columns=["log", "status", "pad_friction_f"]).to_pylist()
        return {Path(row["log"]).name: (row["status"], row["pad_friction_f"]) for row in rows}

    def _diagnosis(self, case: str) -> Diagnosis:
        """The diagnosis of a hidden case from two logs and one hold-out."""
        searched = [self.log(f"{case}/calibration/{name}.parquet") for name in SEARCHED[case]]
        held = self.log(f"{case}/holdout/stop_a.parquet")
        return diagnose(self.vehicle(f"{case}/vehicle.toml"), searched, [held])
