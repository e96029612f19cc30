"""Speed of the estimator against the plain ways, in one run.

    python tests/benchmarks/bench_estimator.py

Prints nanoseconds a sample and ratios; nothing is asserted, machines differ. Needs the extra
`bench` (padasip, filterpy).
"""

import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from calib.car.vehicle_file import read_vehicle  # noqa: E402
from calib.estimation import adaptive, estimator  # noqa: E402
from calib.estimation.plan import plan_for  # noqa: E402
from calib.fitting.fit import fit  # noqa: E402
from calib.logs.read import read_log  # noqa: E402
from calib.run.axle_signals import signals  # noqa: E402
from calib.run.blocks import blocks  # noqa: E402
from calib.run.brake_response import brake_balance  # noqa: E402
from tests.benchmarks.timing import best  # noqa: E402

SAMPLES = ROOT / "sample_logs"
REPEAT = 7


def loop_gradient(y: np.ndarray, u: np.ndarray, gamma: float, dt: float) -> np.ndarray:
    """The adaptive law as one writes it first: a Python loop over samples."""
    theta, out = 0.0, np.empty_like(y)
    for k in range(y.size):
        theta += gamma * dt * u[k] * (y[k] - theta * u[k])
        out[k] = theta
    return out


def padasip_rls(y: np.ndarray, u: np.ndarray) -> None:
    """padasip's recursive least squares, one weight."""
    import padasip

    filt = padasip.filters.FilterRLS(1, mu=0.995)
    filt.run(y, u[:, None])


def filterpy_kalman(y: np.ndarray, u: np.ndarray) -> None:
    """filterpy's Kalman filter, one state."""
    from filterpy.kalman import KalmanFilter

    f = KalmanFilter(dim_x=1, dim_z=1)
    f.R *= 4.0
    f.Q *= 1e-6
    for k in range(y.size):
        f.predict()
        f.update(y[k], H=np.array([[u[k]]]))


def recursions() -> None:
    """One scalar parameter over a long signal, every way."""
    rng = np.random.default_rng(1)
    n, dt = 100_000, 0.005
    u = 50.0 + 10.0 * np.sin(np.arange(n) * dt)
    y = 0.1 * u + rng.normal(0.0, 2.0, n)
    gamma = 5.0 / 50.0**2
    short = slice(0, 5000)
    ways: list[tuple[str, Callable[[], object], int]] = [
        ("gradient law (25), bidiagonal solve", lambda: adaptive.gradient(y, u, gamma, dt), n),
        ("recursive least squares, filters", lambda: adaptive.least_squares(y, u, 1.0, dt), n),
        ("gradient law, Python loop", lambda: loop_gradient(y[short], u[short], gamma, dt), 5000),
        ("padasip FilterRLS", lambda: padasip_rls(y[short], u[short]), 5000),
        ("filterpy KalmanFilter", lambda: filterpy_kalman(y[short], u[short]), 5000),
    ]
    rows = [(name, best(call, 3) / count) for name, call, count in ways]
    base = rows[0][1]
    for name, each in rows:
        print(f"{name:<40} {1e9 * each:10.1f} ns a sample   {each / base:8.1f} x")


def chain() -> None:
    """The whole of `estimate` on a stop, and its parts."""
    car = read_vehicle(SAMPLES / "simulation_study/vehicle.toml")
    ramp = read_log(SAMPLES / "simulation_study/ramp_noisy.parquet")
    stop = read_log(SAMPLES / "simulation_study/stop_noisy.parquet")
    table = fit(car, [ramp])
    n = stop.time.size
    s = signals(stop, car)
    plan = plan_for(table, stop, s)
    forces = brake_balance(plan.nominal, plan.known.effects, s)

    parts = [
        ("signals and blocks", best(lambda: blocks(signals(stop, car)), REPEAT)),
        ("common level", best(lambda: estimator.level_of(plan, s, forces), REPEAT)),
        ("estimate", best(lambda: estimator.estimate(table, stop, with_laws=False), REPEAT)),
        ("estimate, with all baselines", best(lambda: estimator.estimate(table, stop), REPEAT)),
    ]
    for name, seconds in parts:
        print(f"{name:<40} {1e9 * seconds / n:10.1f} ns a sample   {1e3 * seconds:8.2f} ms a log")


def whole_commands() -> None:
    """Wall time of whole processes."""
    print(f"brake-cal --help         {process(['-m', 'cli.main', '--help']):.3f} s")
    imports = "import numpy, scipy.optimize, scipy.signal, pyarrow.csv, pyarrow.parquet, typer"
    sedan = SAMPLES / "sedan"
    with tempfile.TemporaryDirectory() as store:
        fit = ["fit", f"{sedan}/ramp_wet_asphalt.csv", "--vehicle", f"{sedan}/vehicle.toml"]
        fitted = process(["-m", "cli.main", *fit, "--store", store])
    print(f"fit of one ramp          {fitted:.3f} s; its imports {process(['-c', imports]):.3f} s")


def process(arguments: list[str]) -> float:
    """Least wall time of a Python process [s]."""
    run = [sys.executable, *arguments]
    return best(lambda: subprocess.run(run, cwd=ROOT, check=True, capture_output=True), 5)


if __name__ == "__main__":
    recursions()
    chain()
    whole_commands()
