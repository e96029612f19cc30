"""The goals on the sample logs: the paper's Section IV, wet roads, the third-party car.

    python tests/studies/goals.py

The sedan's logs were made with pads of 0.52/0.55 (basalt), 0.50/0.50 (wet tile) and 1/1 (dry) times
nominal; the other logs carry their truth. Nothing of it was used by the program.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.car.vehicle import Vehicle
from calib.car.vehicle_file import read_vehicle
from calib.estimation.estimator import Estimate, estimate
from calib.estimation.metrics import accuracy, truth_of
from calib.fitting.fit import fit
from calib.help.samples import sample_logs
from calib.logs.log import Log
from calib.logs.read import read_log
from calib.table.table import Table

HERE = sample_logs()
SEDAN_PADS = {
    "dry_asphalt_stop": (1.0, 1.0),
    "transition_dry_to_basalt": (1.0, 1.0),
    "basalt_wet_pads": (0.52, 0.55),
    "wet_tile_wet_pads": (0.50, 0.50),
}


def log_of(folder: str, name: str) -> Log:
    """A sample log."""
    return read_log(next((HERE / folder).glob(f"{name}.*")))


def car_of(folder: str, name: str = "vehicle") -> Vehicle:
    """A sample vehicle."""
    return read_vehicle(HERE / folder / f"{name}.toml")


def line(name: str, e: Estimate, truth: tuple[np.ndarray, np.ndarray]) -> None:
    """Errors of one stop: 0.3 s after the bite, mean over valid samples, at the end; intervals."""
    counted = np.flatnonzero(e.braked & (e.speed > 3.0))
    early = int(np.searchsorted(e.time, e.time[counted[0]] + 0.3))
    parts = [f"{name:<26}"]
    held = []
    for axle, mu in zip((e.front, e.rear), truth, strict=True):
        error = 100.0 * (axle.pad_friction / mu - 1.0)
        width = 50.0 * np.median(((axle.upper - axle.lower) / axle.pad_friction)[e.valid])
        held.append(np.mean(((mu >= axle.lower) & (mu <= axle.upper))[e.valid]))
        parts.append(
            f"{error[early]:+6.1f} {np.mean(error[e.valid]):+6.2f} {error[counted[-1]]:+6.2f} "
            f"+-{width:4.1f} |"
        )
    share = np.sum(e.valid[counted]) / counted.size
    parts.append(f"valid {share:.2f}  truth held {np.mean(held):.2f}")
    print(" ".join(parts))


def constant(e: Estimate, front: float, rear: float) -> tuple[np.ndarray, np.ndarray]:
    """Truth that does not change."""
    return np.full_like(e.z, front), np.full_like(e.z, rear)


def sedan(names: tuple[str, ...]) -> None:
    """The stops of the reference car with a table of the named logs."""
    car = car_of("sedan")
    table = fit(car, [log_of("sedan", name) for name in names])
    print(f"\nsedan, table from {', '.join(names)}")
    for name, (f, r) in SEDAN_PADS.items():
        e = estimate(table, log_of("sedan", name))
        line(name, e, constant(e, f * car.front.pad_friction, r * car.rear.pad_friction))


def simulated(table: Table, vehicle: Vehicle | None, title: str) -> None:
    """Section IV, with the gain in torque over nominal pads."""
    log = log_of("simulation_study", "stop_noisy")
    e = estimate(table, log, vehicle)
    car = vehicle or table.vehicle
    truth = truth_of(log, car, e)
    assert truth is not None
    line(title, e, constant(e, 0.4, 0.4))
    print(f"{'':<26} torque rms {accuracy(car, e, truth)['gain_over_nominal']:.1f} times smaller")


def third_party() -> None:
    """The multi-body car."""
    car = car_of("third_party")
    table = fit(car, [log_of("third_party", "cal_ramp")])
    print("\nthird party, table from cal_ramp")
    squares = []
    for path in sorted((HERE / "third_party").glob("hold*")):
        log = read_log(path)
        e = estimate(table, log)
        line(path.stem, e, (log.truth["true_mu_pad_f"], log.truth["true_mu_pad_r"]))
        truth = truth_of(log, car, e)
        assert truth is not None
        found = accuracy(car, e, truth)
        by_load = [found[f"normalised_force_rmse_{side}"] for side in "fr"]
        squares.append([*by_load, *against_true_load(e, log)])
        print(f"{'':<26} normalised force rmse {by_load[0]:.4f} {by_load[1]:.4f} over the load of "
              f"(6) (7), {squares[-1][2]:.4f} {squares[-1][3]:.4f} over the true load")  # fmt: skip
    pooled = np.sqrt(np.mean(np.square(squares), axis=0))
    print("all hold-outs: " + " ".join(f"{value:.4f}" for value in pooled))


def against_true_load(e: Estimate, log: Log) -> tuple[float, float]:
    """Rms error of the normalised force when truth is divided by the true load [1]."""
    braked = e.braked & (e.speed > 3.0)
    out = []
    for side, axle in (("f", e.front), ("r", e.rear)):
        force = np.abs(log.truth[f"true_Fx_{side}l"] + log.truth[f"true_Fx_{side}r"])
        load = log.truth[f"true_Fz_{side}l"] + log.truth[f"true_Fz_{side}r"]
        error = (axle.normalised_force - force / load)[braked]
        out.append(float(np.sqrt(np.mean(error**2))))
    return out[0], out[1]


def main() -> None:
    """Print everything."""
    print(
        "pad friction error %: 0.3 s after the bite, mean of valid samples, at the end, half width"
    )
    print(f"{'':<26} {'front':^29} {'rear':^29}")
    right = fit(car_of("simulation_study"), [log_of("simulation_study", "ramp_noisy")])
    wrong_car = car_of("simulation_study", "vehicle_wrong_pads")
    wrong = fit(wrong_car, [log_of("simulation_study", "ramp_noisy")])
    print("\nSection IV, pads 0.4, nominal 0.5/0.6")
    simulated(right, wrong_car, "table with correct pads")
    simulated(wrong, wrong_car, "table with wrong pads")
    simulated(wrong, None, "the same, its own scale")
    sedan(("ramp_wet_asphalt", "ramp_wet_asphalt_repeat", "coast"))
    sedan(("ramp_wet_asphalt",))
    third_party()


if __name__ == "__main__":
    main()
