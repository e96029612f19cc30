"""The main job without what Windows lacks, on a disk that lets no open file be replaced or removed.

No Windows can be had here: modules and functions that it lacks are taken away in a process of its
own, and an audit hook refuses to move or remove what that process has open. Packages of extras are
taken away, too: the main job needs none.
"""

import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

TAKEN_AWAY = textwrap.dedent(
    """
    import os, signal, sys

    sys.modules["fcntl"] = None
    for module, name in (
        *((os, name) for name in ("O_NOFOLLOW", "O_NONBLOCK", "O_CLOEXEC", "fork")),
        (signal, "SIGHUP"),
    ):
        delattr(module, name)

    class Missing:
        extras = {"pandas", "elftools", "asammdf", "can", "cantools", "minisign", "distributed"}

        def find_spec(self, name, path=None, target=None):
            if name.split(".")[0] in self.extras:
                raise ModuleNotFoundError(f"No module named {name!r}", name=name)

    sys.meta_path.insert(0, Missing())

    CHANGES = ("os.rename", "os.remove", "os.rmdir", "shutil.rmtree")

    def in_use(path):
        for handle in os.listdir("/proc/self/fd"):
            try:
                file = os.readlink(f"/proc/self/fd/{handle}")
            except OSError:
                continue
            if file == path or file.startswith(f"{path}/"):
                return True
        return False

    def hook(event, arguments):
        if event in CHANGES:
            for path in arguments[:2] if event == "os.rename" else arguments[:1]:
                path = os.path.realpath(path)
                if in_use(path) and not path.endswith(".lock"):  # filelock removes its own lock
                    print("in use:", event, path, file=sys.stderr)
                    raise PermissionError(13, "in use by this process", path)

    sys.addaudithook(hook)
    """
)

IMPORTS = """
import importlib, pkgutil
import calib, cli

for package in (calib, cli):
    for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
        if not module.name.startswith("calib.ecu.fmu_"):
            importlib.import_module(module.name)
print("imported")
"""

RUNS = """
from cli.main import main

def run(*words):
    sys.argv = ["brake-cal", *words]
    try:
        main()
    except SystemExit as end:
        assert end.code in (None, 0), (words, end.code)

car = ("--vehicle", "VEHICLE")
run("fit", "RAMP", *car, "--json")
run("validate", "CAR", "STOP", "--out", "results")
run("validate", "CAR", "STOP", "--out", "results")
run("tables", "release", "CAR@1", "--reason", "a test", "--evidence", "results/summary.json")
run("tables", "export", "CAR", "--format", "csv", "--out", "car.csv")
run("tables", "export", "CAR", "--format", "csv", "--out", "car.csv")
run("tables", "verify")
"""


def run(code, folder):
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "XDG_STATE_HOME": str(folder)}
    return subprocess.run(
        [sys.executable, "-W", "ignore", "-c", TAKEN_AWAY + code],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.skipif(sys.platform != "linux", reason="looks for open files in /proc")
def test_every_module_is_imported_without_what_windows_lacks(tmp_path):
    ran = run(IMPORTS, tmp_path)
    assert ran.stdout.strip() == "imported", ran.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="looks for open files in /proc")
def test_fit_validate_release_and_export_without_what_windows_lacks(tmp_path):
    logs = ROOT / "sample_logs" / "simulation_study"
    code = RUNS.replace("VEHICLE", str(logs / "vehicle.toml")).replace("CAR", "sedan-sim")
    code = code.replace("RAMP", str(logs / "ramp_noisy.parquet"))
    code = code.replace("STOP", str(logs / "stop_noisy.parquet"))
    ran = run(code, tmp_path)
    assert ran.returncode == 0, ran.stderr
    assert "in use:" not in ran.stderr
    assert (tmp_path / "car.csv").is_file()
    hidden = [p for p in tmp_path.rglob(".*") if p.name != ".gitattributes"]
    assert hidden == []


BREAK = """
signal.SIGBREAK = signal.SIGUSR1

def pressed(event, arguments):
    if event == "open" and str(arguments[0]).endswith("vehicle.toml"):
        signal.raise_signal(signal.SIGBREAK)

sys.addaudithook(pressed)
from cli.main import main

sys.argv = ["brake-cal", "vehicle", "show", "VEHICLE"]
main()
"""


@pytest.mark.skipif(sys.platform != "linux", reason="Ctrl-Break is a signal of Linux here")
def test_ctrl_break_stops_a_run_as_ctrl_c_does(tmp_path):
    vehicle = ROOT / "sample_logs" / "simulation_study" / "vehicle.toml"
    assert run(BREAK.replace("VEHICLE", str(vehicle)), tmp_path).returncode == 130
