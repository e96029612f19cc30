"""Where the results of a page come from: files with their digests, vehicle, versions, date."""

import platform
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

from calib.base.digest import file_digest
from calib.base.program import PROGRAM
from calib.car.vehicle import Axle, Vehicle
from calib.show.facts import Facts
from calib.show.facts import Table as Cells
from calib.store.version import Stored
from calib.table.table import Table

PACKAGES = ("numpy", "scipy", "matplotlib")
"""Packages that compute and draw."""
_DIGESTS = "Inputs, with the SHA-256 of their bytes."


@dataclass(frozen=True)
class PageOrigin:
    """``date`` as it stands on the page; ``files`` (role, name, SHA-256) that are no logs."""

    date: str
    files: tuple[tuple[str, str, str], ...] = ()


def origin_of(date: str, files: Mapping[str, Path | None]) -> PageOrigin:
    """The origin with the files that were given, by role. Raises OSError for one that is gone."""
    given = [(role, path.name, file_digest(path)) for role, path in files.items() if path]
    return PageOrigin(date, tuple(given))


def origin(
    given: PageOrigin, stored: Stored, logs: Iterable[tuple[str, str, str]], mass: str
) -> Facts:
    """Where the results come from; ``logs`` (role, name, SHA-256)."""
    table = stored.table
    inputs = [(name, role, digest) for role, name, digest in (*logs, *given.files)]
    car = [("Name", table.vehicle.name), ("Mass", mass), *_vehicle(table.vehicle)]
    return Facts(
        "Where it comes from",
        rows=[
            ("Table", f"{stored.id}, SHA-256 {stored.digest}"),
            ("Date", given.date or "not stated"),
            ("Program", PROGRAM),
            ("Runs on", f"Python {platform.python_version()}, " + ", ".join(_packages())),
        ],
        tables=[Cells(("file", "role", "SHA-256"), inputs, _DIGESTS)],
        parts=[Facts("The vehicle", rows=car, folded=True), settings(table)],
    )


def settings(table: Table) -> Facts:
    """The settings of the fit of ``table``, shown on demand."""
    rows = [(name, f"{value:g}") for name, value in sorted(table.provenance.settings.items())]
    return Facts("Settings, in SI", tables=[Cells(("setting", "value"), rows)], folded=True)


def _packages() -> list[str]:
    return [f"{name} {version(name)}" for name in PACKAGES]


def _vehicle(car: Vehicle) -> list[tuple[str, str]]:
    return [
        ("Centre of gravity", f"{car.cg_height:.3g} m high, {car.cg_to_front_axle:.4g} m behind "
         f"the front axle, {car.cg_to_rear_axle:.4g} m before the rear one"),
        ("Track", f"{car.track_width:.4g} m"),
        ("Front axle", _axle(car.front)),
        ("Rear axle", _axle(car.rear)),
        ("Known effects", ", ".join(car.effects.parameters) or "none"),
    ]  # fmt: skip


def _axle(axle: Axle) -> str:
    """An axle in a line: what its torque for a pressure is made of."""
    return (
        f"{1e5 * axle.torque_gain * axle.pad_friction:.3g} N m a bar and wheel at pad friction "
        f"{axle.pad_friction:g}, rolling radius {1e3 * axle.rolling_radius:.4g} mm"
    )
