"""The forces of a roller brake tester as a TOML file.

    schema = 1
    tolerance = 0.01                                    # one sigma; may be left out

    [front]
    p_mc = ["10 bar", "20 bar", "30 bar"]
    brake_force = ["2.2 kN", "4.5 kN", "6.8 kN"]        # of both wheels

    [rear]
    p_mc = ["10 bar", "20 bar", "30 bar"]
    brake_force_left = ["0.41 kN", "0.83 kN", "1.26 kN"]
    brake_force_right = ["0.40 kN", "0.85 kN", "1.25 kN"]

A pressure and the forces at the same place of their lists are one row.
"""

from pathlib import Path
from typing import Annotated, Any

from pydantic import model_validator

from calib.base.digest import file_digest
from calib.base.errors import BenchError
from calib.base.plain import counted
from calib.base.record import FileSchema, QuantityMark, Section, read_toml
from calib.base.record_errors import wrong
from calib.base.units import from_si
from calib.car.braking import BITE
from calib.model.roller_bench import TOLERANCE, AxleOnRollers, RollerBench

_FEWEST = 3
"""Pressures of an axle: two make a line, the third shows its scatter."""

_Pressure = Annotated[float, QuantityMark("Pa", 0.0, 4e7)]
_Force = Annotated[float, QuantityMark("N", 1.0, 2e5)]


class _AxleRows(Section):
    """The rows of one axle: forces of both wheels together, or of each."""

    p_mc: list[_Pressure]
    brake_force: list[_Force] | None = None
    brake_force_left: list[_Force] | None = None
    brake_force_right: list[_Force] | None = None

    @model_validator(mode="after")
    def _are_rows(self: Any) -> Any:
        forces = (self.brake_force, self.brake_force_left, self.brake_force_right)
        columns = [force for force in forces if force is not None]
        if len(columns) != (2 if self.brake_force is None else 1):
            raise wrong(
                f"{counted(len(columns), 'list')} of brake forces",
                "brake_force of both wheels, or brake_force_left and brake_force_right",
            )
        counts = [len(one) for one in (self.p_mc, *columns)]
        if len(set(counts)) > 1:
            raise wrong(
                f"{counts[0]} pressures and {' and '.join(map(str, counts[1:]))} forces",
                "a force for each pressure",
            )
        if len(set(self.p_mc)) < _FEWEST:
            raise wrong(
                f"{counted(len(set(self.p_mc)), 'pressure')}",
                f"{_FEWEST} different ones or more, for slope, threshold and scatter of the forces",
            )
        lowest, bite = (from_si(p, "bar", "Pa") for p in (min(self.p_mc), BITE))
        if lowest < bite:
            raise wrong(
                f"a pressure of {lowest:g} bar",
                f"{bite:g} bar or more",
                "leave that row out: the brakes hardly bite there",
            )
        return self

    @property
    def rows(self) -> AxleOnRollers:
        """Pressure, and force of both wheels."""
        sides = zip(self.brake_force_left or (), self.brake_force_right or (), strict=True)
        force = self.brake_force or [left + right for left, right in sides]
        return AxleOnRollers(tuple(self.p_mc), tuple(force))


class RollerBenchFile(FileSchema):
    """The forces of a roller brake tester, of both axles."""

    tolerance: Annotated[float, QuantityMark("1", 0.0005, 0.2)] = TOLERANCE
    front: _AxleRows
    rear: _AxleRows


def read_roller_bench(path: Path | str) -> RollerBench:
    """Read the forces of a roller brake tester (TOML, ``schema = 1``, quantities with units).

    Raises one BenchError with all that is wrong in it.
    """
    file = read_toml(Path(path), RollerBenchFile, BenchError)
    return RollerBench(
        name=Path(path).stem,
        source=str(path),
        digest=file_digest(Path(path)),
        tolerance=file.tolerance,
        front=file.front.rows,
        rear=file.rear.rows,
    )
