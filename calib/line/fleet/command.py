"""The commands that can be run on many logs."""

from enum import StrEnum


class Command(StrEnum):
    """A command that is run on each log of a batch."""

    FIT = "fit"
    VALIDATE = "validate"
    CHECK = "check"
    DIAGNOSE = "diagnose"
