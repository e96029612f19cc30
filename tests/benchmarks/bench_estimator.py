"""Speed of the estimator against the plain ways, in one run.

    python tests/benchmarks/bench_estimator.py

Prints nanoseconds a sample and ratios; nothing is asserted, machines differ. Needs the extra
`bench` (padasip, filterpy).
"""

import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from calib.car.vehicle_file import read_vehicle  # noqa: E402
from calib.estimation import adaptive, baselines, estimator  # noqa: E402
from calib.estimation.plan import plan_for  # noqa: E402
from calib.estimation.weighed_level import weigh_level  # noqa: E402
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
    b = blocks(s)
    plan = plan_for(table, stop, s)
    forces = brake_balance(plan.nominal, plan.known.effects, s)
    level = estimator.level_of(plan, s, forces)
    weighed = weigh_level(plan, s.speed, s.z, np.zeros(n), level)
    demand = estimator.demand_of(plan, s, b, level, weighed)

    def paper_chain() -> None:
        zero = np.mean(s.omega_r[s.lead_in]) / np.mean(s.omega_f[s.lead_in])
        eta = s.omega_r / s.omega_f / zero
        now = brake_balance(plan.nominal, plan.known.effects, s)
        reading = baselines.read(table, plan.nominal, s, now, eta, "difference", plan.priors)
        baselines.adapt(plan.nominal, s, now, reading, "gradient", plan.priors)

    split = best(lambda: estimator.split_of(plan, b, demand), REPEAT)
    parts = [
        ("signals and blocks", best(lambda: blocks(signals(stop, car)), REPEAT)),
        ("common level", best(lambda: estimator.level_of(plan, s, forces), REPEAT)),
        ("split filter (20 Hz)", split),
        ("paper chain: zero, D look-up, law (25)", best(paper_chain, REPEAT)),
        ("estimate, with all baselines", best(lambda: estimator.estimate(table, stop), REPEAT)),
    ]
    for name, seconds in parts:
        print(f"{name:<40} {1e9 * seconds / n:10.1f} ns a sample   {1e3 * seconds:8.2f} ms a log")
    print(f"split filter: {1e6 * split / b.end.size:.1f} us a step of 50 ms")


def whole_commands() -> None:
    """Wall time of whole processes."""
    help_ = ["-m", "cli.main", "--help"]
    print(f"brake-cal --help                         {process(help_):.3f} s")
    imports = "import numpy, scipy.optimize, scipy.signal, pyarrow.csv, pyarrow.parquet, typer"
    ramp = SAMPLES / "sedan/ramp_wet_asphalt.csv"
    vehicle = SAMPLES / "sedan/vehicle.toml"
    import tempfile

    with tempfile.TemporaryDirectory() as store:
        command = ["-m", "cli.main", "fit", str(ramp), "--vehicle", str(vehicle), "--store", store]
        fitted, imported = process(command), process(["-c", imports])
    print(f"fit of one ramp                          {fitted:.3f} s")
    print(
        f"importing what it imports                {imported:.3f} s   ratio {fitted / imported:.2f}"
    )
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    print(f"largest process so far                   {peak:.0f} MB")


def process(arguments: list[str]) -> float:
    """Least wall time of a Python process [s]."""
    run = [sys.executable, *arguments]
    return best(lambda: subprocess.run(run, cwd=ROOT, check=True, capture_output=True), 5)


if __name__ == "__main__":
    recursions()
    chain()
    whole_commands()
