"""The summary.json that `validate --out` writes, as far as an export reads it."""

from typing import Literal

from pydantic import ConfigDict

from calib.base.record import FileSchema, Section


class LogOutcome(Section):
    """A log that was validated."""

    model_config = ConfigDict(extra="ignore")

    log: str
    role: str
    verdict: str


class SummaryFile(FileSchema):
    """A validation of one version of a table."""

    model_config = ConfigDict(extra="ignore")

    table: str
    digest: str | None = None
    verdict: Literal["passed", "failed"]
    logs: list[LogOutcome]
