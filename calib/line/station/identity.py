"""Who was judged at the line: the identifiers of a car and of its station."""

from dataclasses import asdict, dataclass

_LONGEST = 64
"""Largest number of characters of an identifier."""

TITLES = {"serial": "Serial number", "vin": "VIN", "station": "Station", "rxswin": "RXSWIN"}
"""Names of the identifiers in a report."""


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
        return {name: value for name, value in asdict(self).items() if value is not None}


NOBODY = Identity()


def identifier(text: str) -> str:
    """Return the text of an identifier. Raises ValueError for one that no report can show."""
    if not text.strip() or len(text) > _LONGEST or not text.isprintable():
        raise ValueError(f"not an identifier: 1 to {_LONGEST} characters that can be printed")
    return text
