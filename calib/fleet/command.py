"""The commands that can be run on many logs."""

from enum import StrEnum


class Command(StrEnum):
    """What can be done with each of many logs."""

    FIT = "fit"
    VALIDATE = "validate"
    CHECK = "check"
    DIAGNOSE = "diagnose"
