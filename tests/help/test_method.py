"""The example by hand in the manual, computed by the program."""

import numpy as np
import pytest

import calib
from calib.car.forces import axle_loads
from calib.estimation.lookup import paper, smoothed
from calib.help.page import FOLDER

PAGE = (FOLDER / "method.md").read_text()
LOGS = calib.sample_logs() / "simulation_study"
AT = 7.0  # [s]


@pytest.fixture(scope="module")
def rows() -> dict[str, list[str]]:
    """The cells of the table of the example by the beginning of its first cell."""
    part = PAGE.partition("## An example by hand")[2].partition("## What `fit` does")[0]
    lines = [line.strip("|").split("|") for line in part.splitlines() if line.startswith("|")]
    return {
        cells[0].strip().strip("*"): [c.strip().strip("*") for c in cells[1:]] for cells in lines
    }


@pytest.fixture(scope="module")
def computed() -> dict[str, tuple[float, float]]:
    """What the program has at this sample, front and rear."""
    car = calib.read_vehicle(LOGS / "vehicle.toml")
    table = calib.fit(car, [calib.read_log(LOGS / "ramp_noisy.parquet")])
    log = calib.read_log(LOGS / "stop_noisy.parquet")
    found = calib.estimate(table, log)
    at, s, axles = int(np.argmin(np.abs(found.time - AT))), found.read, (car.front, car.rear)
    z, eta = (smoothed(s, x) for x in (found.z, found.eta))
    spin = [np.gradient(smoothed(s, w), s.time)[at] for w in (s.omega_f, s.omega_r)]
    load = [float(F_z[at]) for F_z in axle_loads(car, z)]
    read = paper(table, z, eta, z)
    assert read.inside[at]
    force = [float(F[at]) for F in (read.F_f, read.F_r)]
    pull = [F * F_z for F, F_z in zip(force, load, strict=True)]
    rim = [0.5 * a.rolling_radius * F_x for a, F_x in zip(axles, pull, strict=True)]
    turning = [-a.wheel_inertia * w for a, w in zip(axles, spin, strict=True)]
    torque = [a + b for a, b in zip(rim, turning, strict=True)]
    c = table.paper
    k = int(np.searchsorted(c.eta, eta[at]))
    return {
        "input": (float(z[at]), float(eta[at])),
        "rows": (float(c.eta[k - 1]), float(c.eta[k])),
        "f1": (float(c.f1[k - 1]), float(c.f1[k])),
        "f2": (float(c.f2[k - 1]), float(c.f2[k])),
        "f": (force[0] - float(z[at]), force[1] - float(z[at])),
        "spin": (spin[0], spin[1]),
        "F": (force[0], force[1]),
        "F_z": (load[0], load[1]),
        "F_x": (pull[0], pull[1]),
        "rim": (rim[0], rim[1]),
        "turning": (turning[0], turning[1]),
        "torque": (torque[0], torque[1]),
        "truth": (float(log.truth["true_Tb_fl"][at]), float(log.truth["true_Tb_rl"][at])),
        "estimate": (float(found.front.torque[at]), float(found.rear.torque[at])),
        "pads": (
            torque[0] / (axles[0].torque_gain * float(s.p_f[at])),
            float(s.p_f[at]) / 1e5,
        ),
    }


@pytest.mark.parametrize(
    ("row", "name", "digits"),
    [
        ("domega/dt", "spin", 2),
        ("f1, f2 at", "f", 4),
        ("F = z + f", "F", 4),
        ("F_z [N]", "F_z", 0),
        ("F_x = F F_z", "F_x", 0),
        ("R F_x/2", "rim", 1),
        ("-J domega/dt", "turning", 1),
        ("brake torque of one wheel", "torque", 1),
        ("truth of the simulation", "truth", 1),
        ("what `validate` says", "estimate", 1),
    ],
)
def test_a_row_of_the_example_is_what_the_program_computes(rows, computed, row, name, digits):
    (cells,) = [cells for head, cells in rows.items() if head.startswith(row)]
    for cell, value in zip(cells, computed[name], strict=True):
        assert cell.split("= ")[-1] == f"{value:.{digits}f}"


def test_the_inputs_and_the_rows_of_the_table(rows, computed):
    z, eta = computed["input"]
    assert f"z = {z:.4f}, eta = {eta:.5f}" in rows
    low, high = computed["rows"]
    f1, f2 = ([f"{value:.4f}" for value in computed[name]] for name in ("f1", "f2"))
    assert rows[f"rows of the table, eta {low:.5f} and {high:.5f}"] == [
        f"f1 = {f1[0]} and {f1[1]}",
        f"f2 = {f2[0]} and {f2[1]}",
    ]
    mu, bar = computed["pads"]
    assert f"At {bar:.1f} bar" in PAGE
    assert f"= {mu:.3f}; the simulation has 0.4" in PAGE
