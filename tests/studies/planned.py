"""Planned against achieved half widths of the torque, on plants that share nothing with the model.

    python -m tests.studies.planned > tests/studies/results/planned.md

Each plan is driven by three plants with noise of other seeds, and fitted. Achieved over planned is
to be within 15 % in the median and never above 1.25.
"""

import sys
from dataclasses import dataclass, replace

import numpy as np

from calib.base.processes import cores
from calib.car.vehicle import Vehicle
from calib.car.vehicle_file import read_vehicle
from calib.fitting.fit import fit
from calib.help.samples import sample_logs
from calib.logs.log import Log
from calib.model.sensor_noise import add_noise
from calib.plan.achieved import HalfWidths, widths_of
from calib.plan.expected import on_rollers, prior_of
from calib.plan.measure import Measure, Track, pressure_trace
from calib.plan.search import Plan, Want, plan
from tests.support.cornering import Tyre
from tests.support.plant import WHEELS, Plant, as_log, brush, burckhardt, drive, dugoff


@dataclass(frozen=True)
class Car:
    """A car as it is: its file, tyre, pads over those of the file, and first speed [m/s]."""

    vehicle: Vehicle
    tyre: Tyre
    pads: tuple[float, float]
    speed: float
    rear_stiffness: float = 1.0

    @property
    def friction(self) -> tuple[float, float]:
        front, rear = (axle.pad_friction for axle in (self.vehicle.front, self.vehicle.rear))
        return self.pads[0] * front, self.pads[1] * rear

    def run(self, measure: Measure, sensors: frozenset[str], seed: int) -> Log:
        """The run as the plant drives it, with noise."""
        time, pressure = pressure_trace(self.vehicle, measure)
        plant = Plant(
            self.vehicle,
            self.tyre,
            pads=lambda t: self.friction,
            drag_area=0.62,
            rolling_resistance=0.011,
            rear_stiffness=self.rear_stiffness,
        )

        def pressure_at(t: float) -> float:
            return float(np.interp(t, time, pressure))

        only = {w: pressure_at if w[0] == measure.axle else (lambda t: 0.0) for w in WHEELS}
        logged = drive(
            plant,
            pressure_at,
            self.speed,
            duration=float(time[-1]),
            wheel_pressure=only if measure.axle else None,
        )
        log = add_noise(as_log(logged, measure.name), seed)
        optional = {"v", *(f"p_{w}" for w in WHEELS)} - sensors
        return replace(log, channels={k: x for k, x in log.channels.items() if k not in optional})


def achieved(car: Car, planned: Plan, seed: int) -> HalfWidths:
    """Half widths of a fit of what the plant drives by the plan."""
    measures = [step.measure for step in planned.steps]
    kinds = {measure.kind for measure in measures}
    runs = [m for m in measures if m.driven]
    logs = [car.run(m, planned.prior.sensors, 100 * seed + i) for i, m in enumerate(runs)]
    bench = on_rollers(car.vehicle, car.friction, seed) if "rollers" in kinds else None
    mass = car.vehicle.mass if "weighing" in kinds else None
    return widths_of(fit(car.vehicle, logs, mass=mass, bench=bench))


def main(seeds: int = 2) -> None:
    samples = sample_logs()
    vehicles = [
        read_vehicle(samples / name / "vehicle.toml")
        for name in ("sedan", "hidden/case_5", "third_party")
    ]
    cars = {
        "sedan, brush": Car(vehicles[0], brush(32.0, 0.95), (0.92, 1.03), 33.0),
        "case 5, Burckhardt": Car(vehicles[1], burckhardt(28.0, 1.0), (1.05, 0.95), 31.0, 0.95),
        "third party, Dugoff": Car(vehicles[2], dugoff(30.0, 1.0), (1.0, 1.08), 33.0, 1.05),
    }
    pressures = frozenset(f"p_{w}" for w in WHEELS)
    cases = {
        "ramp, no v": (frozenset[str](), 30.0),
        "30 s, v": (frozenset({"v"}), 30.0),
        "60 s, v and wheel pressures": (pressures | {"v"}, 60.0),
        "all, v": (frozenset({"v"}), np.inf),
    }
    print(
        "| car | plan | planned front, rear, total [%] | achieved over planned |\n|---|---|---|---|"
    )
    ratios = []
    for name, car in cars.items():
        for case, (sensors, seconds) in cases.items():
            prior = prior_of(car.vehicle, Track(speed=car.speed), sensors)
            planned = plan(prior, Want(seconds=seconds), cores())
            steps = ", ".join(step.measure.name for step in planned.steps)
            widths = " ".join(f"{100.0 * w:.1f}" for w in planned.after)
            shares = [np.divide(achieved(car, planned, s + 1), planned.after) for s in range(seeds)]
            ratios += shares
            text = "; ".join(" ".join(f"{x:.2f}" for x in share) for share in shares)
            print(f"| {name} | {case}: {steps} | {widths} | {text} |", flush=True)
    inverse = 1.0 / np.array(ratios)
    print(f"\nAchieved over planned, median {np.median(ratios):.3f}, largest {np.max(ratios):.2f}")
    print(f"Planned over achieved, least {inverse.min():.2f}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
