"""The tables in `tables/`, which the demo makes, and the pictures in `sample_logs/figures/`.

    python -m tests.support.sample_store

Run it after a change of what `fit`, `validate` or `plot` give, look at the pictures, and commit
both. `tests/cli/test_demo.py` says whether they are those of the program as it is.
"""

import os
import shutil
import tempfile
from pathlib import Path

from calib.car.vehicle_file import read_vehicle
from calib.diagnosis.diagnose import diagnose
from calib.logs.read import read_log
from calib.show.diagnosis_figure import diagnosis_sheet
from calib.show.sheet import save
from tests.support.manual import run

ROOT = Path(__file__).parents[2]
STORE = ROOT / "tables"
_DRAWN = {
    "table": "sedan-2up@2 sample_logs/sedan/ramp*.csv",
    "stop": "sedan-2up@2 sample_logs/sedan/basalt_wet_pads.csv --figure axle-torques",
}
"""Picture, and what `brake-cal plot` draws there in the folder of the demo."""
PICTURES = (*_DRAWN, "diagnosis")

_RELEASES = {
    "sedan-2up@2": ("sedan/dry_asphalt_stop.csv", "sedan/basalt_wet_pads.csv"),
    "sedan-sim@1": ("simulation_study/stop_noisy.parquet",),
    "escort@1": (
        "third_party/hold1_const_mu30.parquet",
        "third_party/hold4_driver_mu28.parquet",
    ),
}
"""Tables that are released, and the stops that they are released on."""


def picture(name: str) -> Path:
    """A picture of the README and the manual."""
    return ROOT / "sample_logs" / "figures" / f"{name}.png"


def draw(demo: Path) -> None:
    """Draw each picture into the figures of the demo."""
    for name, inputs in _DRAWN.items():
        assert run(demo, f"brake-cal plot {inputs} --out figures/{name}.png") == 0
    case = demo / "sample_logs/hidden/case_2"
    calibration, holdouts = (
        [read_log(path) for path in sorted((case / part).iterdir())]
        for part in ("calibration", "holdout")
    )
    car = read_vehicle(case / "vehicle.toml")
    drawn = diagnosis_sheet(diagnose(car, calibration, holdouts))
    save({demo / "figures/diagnosis.png": [drawn.overview()]})


def main() -> None:
    """Make all of it anew."""
    os.environ["LOGNAME"] = "brake-cal"  # who stores, in the journal
    with tempfile.TemporaryDirectory() as folder:
        demo = Path(folder) / "brake-cal-demo"
        lines = ["brake-cal demo"]
        for table, stops in _RELEASES.items():
            logs = " ".join(f"{demo}/sample_logs/{stop}" for stop in stops)
            store, proof = f"--store {demo}/tables", f"{folder}/{table}"
            names = ", ".join(Path(stop).stem for stop in stops)
            lines += [
                f"brake-cal validate {table} {logs} {store} --out {proof}",
                f"brake-cal tables release {table} {store} "
                f"--evidence {proof}/summary.json --reason 'holds its limits on {names}'",
            ]
        for line in lines:
            if code := run(Path(folder), line):
                raise SystemExit(f"ended with {code}: {line}")
        draw(demo)
        shutil.rmtree(STORE)
        shutil.copytree(demo / "tables", STORE)
        for name in PICTURES:
            shutil.copyfile(demo / "figures" / f"{name}.png", picture(name))


if __name__ == "__main__":
    main()
