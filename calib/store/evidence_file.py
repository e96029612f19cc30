"""What `validate` and `station` wrote, as far as a state of a version rests on it."""

from typing import Literal

from pydantic import ConfigDict

from calib.base.schema import FileSchema, Section


class LogOutcome(Section):
    """A log that was validated."""

    model_config = ConfigDict(extra="ignore")

    log: str
    role: str
    verdict: str


class SummaryFile(FileSchema):
    """The `summary.json` of a validation of one version of a table."""

    model_config = ConfigDict(extra="ignore")

    table: str
    digest: str | None = None
    verdict: Literal["passed", "failed"]
    logs: list[LogOutcome]


class JudgedTable(Section):
    """The table that was judged."""

    model_config = ConfigDict(extra="ignore")

    id: str
    digest: str


class StationFile(FileSchema):
    """The `station.json` of one car."""

    model_config = ConfigDict(extra="ignore")

    verdict: Literal["passed", "warning", "failed"]
    table: JudgedTable
