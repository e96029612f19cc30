"""The `station.json` of `brake-cal station`, as far as a state rests on it."""

from typing import Literal

from pydantic import ConfigDict

from calib.base.record import FileSchema, Section


class JudgedTable(Section):
    """The table that was judged."""

    model_config = ConfigDict(extra="ignore")

    id: str
    digest: str


class StationFile(FileSchema):
    """The verdict on one car."""

    model_config = ConfigDict(extra="ignore")

    verdict: Literal["passed", "warning", "failed"]
    table: JudgedTable
