"""The JSON document that a command with --json prints where it ends with an error.

{"schema": 1, "error": {"kind": "log", "message": "ramp.csv: no such file; ...", "exit_code": 3,
                        "what": "no such file", "where": "ramp.csv", "expected": "a log",
                        "do": "check the path", "lines": []}}
"""

from typing import Annotated

from pydantic import Field

from calib.documents.schema import FileSchema, Section


class ErrorSection(Section):
    """The error."""

    kind: Annotated[
        str, Field(description="usage, log, vehicle, limits, store, table_not_found and so on")
    ]
    message: Annotated[str, Field(description="the whole message, as on stderr")]
    exit_code: Annotated[int, Field(ge=1, le=255)]
    what: Annotated[str, Field(description="what was wrong, and what was given")]
    where: Annotated[str, Field(description="file, channel, key or option; empty if there is none")]
    expected: Annotated[str, Field(description="what is valid; may be empty")]
    do: Annotated[str, Field(description="the next step; may be empty")]
    lines: Annotated[list[str], Field(description="each mistake, where a file has several")]


class ErrorFile(FileSchema):
    """A command that ended with an error."""

    error: ErrorSection
