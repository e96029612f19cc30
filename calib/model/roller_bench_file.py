"""Read the forces of a roller brake tester from a TOML file.

    schema = 1
    tolerance = 0.01                                    # one standard deviation; may be left out

    [front]
    p_mc = ["10 bar", "20 bar", "30 bar"]
    brake_force = ["2.2 kN", "4.5 kN", "6.8 kN"]        # of both wheels together

    [rear]
    p_mc = ["10 bar", "20 bar", "30 bar"]
    brake_force = ["0.81 kN", "1.68 kN", "2.51 kN"]

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

_FEWEST = 3  # pressures of an axle: two give a line, the third shows its scatter

_Pressure = Annotated[float, QuantityMark("Pa", 0.0, 4e7)]
_Force = Annotated[float, QuantityMark("N", 1.0, 2e5)]


class _AxleRows(Section):
    p_mc: list[_Pressure]
    brake_force: list[_Force]  # of both wheels together

    @model_validator(mode="after")
    def _are_rows(self: Any) -> Any:
        if len(self.p_mc) != len(self.brake_force):
            flaw = f"{len(self.p_mc)} pressures and {len(self.brake_force)} forces"
            raise wrong(flaw, "a force of both wheels for each pressure")
        count = len(set(self.p_mc))
        if count < _FEWEST:
            expected = f"{_FEWEST} or more, for slope, threshold and scatter of the forces"
            raise wrong(counted(count, "different pressure"), expected)
        lowest, bite = from_si(min(self.p_mc), "bar", "Pa"), from_si(BITE, "bar", "Pa")
        if lowest < bite:
            do = "leave that row out: the brakes hardly bite there"
            raise wrong(f"a pressure of {lowest:g} bar", f"{bite:g} bar or more", do)
        return self

    @property
    def rows(self) -> AxleOnRollers:
        return AxleOnRollers(tuple(self.p_mc), tuple(self.brake_force))


class RollerBenchFile(FileSchema):
    """A file with the forces of both axles."""

    tolerance: Annotated[float, QuantityMark("1", 0.0005, 0.2)] = TOLERANCE
    front: _AxleRows
    rear: _AxleRows


def read_roller_bench(path: Path | str) -> RollerBench:
    """Read the forces of a roller brake tester (TOML, ``schema = 1``, quantities with units).

    Raises one BenchError that lists all that is wrong in the file.
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
