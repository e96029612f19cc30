"""What is installed is what stands in the checkout: the packages are listed by hand."""

import json
import tomllib
from itertools import pairwise
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]


def test_every_package_of_the_checkout_is_installed():
    with (ROOT / "pyproject.toml").open("rb") as file:
        listed = tomllib.load(file)["tool"]["setuptools"]["packages"]
    packages = {
        ".".join(init.relative_to(ROOT).parts[:-1])
        for top in ("calib", "cli")
        for init in (ROOT / top).rglob("__init__.py")
    }
    assert {name for name in listed if name != "calib.help.sample_logs"} == packages


def test_every_table_of_data_is_installed():
    with (ROOT / "pyproject.toml").open("rb") as file:
        data = tomllib.load(file)["tool"]["setuptools"]["package-data"]["calib"]
    installed = {path for pattern in data for path in (ROOT / "calib").glob(pattern)}
    assert set((ROOT / "calib").rglob("*.csv")) <= installed


def test_the_lock_and_the_list_of_parts_have_every_package_of_the_core():
    with (ROOT / "pyproject.toml").open("rb") as file:
        declared = tomllib.load(file)["project"]["dependencies"]
    needed = {Requirement(line).name for line in declared}
    lines = (ROOT / ".ci/requirements.lock").read_text().splitlines()
    locked = {line.split("==")[0]: line for line in lines if "==" in line}
    parts = json.loads((ROOT / ".ci/sbom.json").read_text())["components"]
    assert needed <= locked.keys()
    assert needed <= {part["name"].lower() for part in parts}
    assert all(after.strip().startswith("--hash=sha256:") for after in following(lines))


def following(lines):
    """The line after each one that names a package."""
    return [after for line, after in pairwise(lines) if "==" in line]
