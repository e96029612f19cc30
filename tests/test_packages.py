"""What is installed is what stands in the checkout: the packages are listed by hand."""

import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_every_package_of_the_checkout_is_installed():
    with (ROOT / "pyproject.toml").open("rb") as file:
        listed = tomllib.load(file)["tool"]["setuptools"]["packages"]
    there = {
        ".".join(init.relative_to(ROOT).parts[:-1])
        for top in ("calib", "cli")
        for init in (ROOT / top).rglob("__init__.py")
    }
    assert {name for name in listed if name != "calib.help.sample_logs"} == there


def test_every_table_of_data_is_installed():
    with (ROOT / "pyproject.toml").open("rb") as file:
        data = tomllib.load(file)["tool"]["setuptools"]["package-data"]["calib"]
    installed = {path for pattern in data for path in (ROOT / "calib").glob(pattern)}
    assert set((ROOT / "calib").rglob("*.csv")) <= installed
