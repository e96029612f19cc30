"""Identifiers of the car and the station, as the systems of the line use them."""

import re
from dataclasses import dataclass, fields

LONGEST = 64
"""Largest number of characters of an identifier."""

VIN = "[A-HJ-NPR-Z0-9]{17}"
"""A vehicle identification number, ISO 3779."""


@dataclass(frozen=True)
class Identity:
    """Identifiers of a run at the line, each None where none was given.

    ``serial`` of the car or brake control unit; ``vin``; ``station`` where it ran; ``rxswin`` the
    software identification of UN R156.
    """

    serial: str | None = None
    vin: str | None = None
    station: str | None = None
    rxswin: str | None = None

    def given(self) -> dict[str, str]:
        """The identifiers that were given, by name.

        >>> Identity(vin="WVWZZZ1JZXW000001").given()
        {'vin': 'WVWZZZ1JZXW000001'}
        """
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        return {name: value for name, value in values.items() if value is not None}

    def doubt(self) -> str:
        """What is unusual of the VIN; "" if nothing is. Cars before series have such ones."""
        if self.vin is None or re.fullmatch(VIN, self.vin):
            return ""
        return (
            f"vin {self.vin!r} is not of the form of ISO 3779, which has 17 letters and digits "
            "without I, O and Q; it is taken as it is"
        )

    def flaw(self) -> tuple[str, str] | None:
        """Name of the first identifier that is not valid, and why; None if all are valid."""
        for name, value in self.given().items():
            if not value.strip():
                return name, "is empty"
            if len(value) > LONGEST:
                return name, f"has {len(value)} characters, at most {LONGEST} are taken"
            if not value.isprintable():
                return name, "holds characters that cannot be printed"
        return None


TITLES = {
    "serial": "Serial number",
    "vin": "VIN",
    "station": "Station",
    "rxswin": "RXSWIN",
}
"""Names of the identifiers in a report."""
