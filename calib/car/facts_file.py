"""The document of `brake-cal vehicle show --json`, with its schema."""

from typing import Annotated

from pydantic import ConfigDict, Field

from calib.base.schema import FileSchema, Section
from calib.base.warning import to_dict
from calib.car.follows import VehicleFacts, what_follows
from calib.car.plausible import plausible
from calib.car.vehicle import Vehicle


class WarningEntry(Section):
    """A figure outside its usual range; a bound that is not there is null."""

    model_config = ConfigDict(strict=False)

    code: str
    log: Annotated[str, Field(description="name of the vehicle")]
    measured: float
    expected: tuple[float | None, float | None]
    causes: Annotated[list[str], Field(description="the most likely first")]
    do: str


class VehicleFactsFile(FileSchema):
    """What follows from a vehicle file, in bar, kg, m, N m and g."""

    name: str
    facts: VehicleFacts
    warnings: list[WarningEntry]


def facts_document(vehicle: Vehicle) -> VehicleFactsFile:
    """The document of a vehicle."""
    warnings = [WarningEntry(**to_dict(one)) for one in plausible(vehicle)]
    return VehicleFactsFile(
        schema=1, name=vehicle.name, facts=what_follows(vehicle), warnings=warnings
    )
