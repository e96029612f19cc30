"""A channel map: which column of a foreign log is which channel, with unit and sign."""

from dataclasses import dataclass
from pathlib import Path

from calib.logs.source import Array
from calib.logs.text.dialect import LOOKED, TextFormat
from calib.units import to_si

METHODS = ("linear", "hold")


@dataclass(frozen=True)
class Mapping:
    """One channel's origin.

    Attributes
    ----------
    source : name of the column, as the file has it without its unit.
    unit : unit of the values after scale and offset; None takes the header's.
    sign, scale, offset : value = sign * (scale * written + offset).
    method : what it is between its samples, one of `METHODS`; None lets the file say.
    """

    source: str
    unit: str | None = None
    sign: int = 1
    scale: float = 1.0
    offset: float = 0.0
    method: str | None = None

    def to_si(self, written: Array, unit: str, si: str) -> Array:
        """Values in SI, shape (n,), from what the file holds. Raises UnknownUnit."""
        return to_si(self.sign * (self.scale * written + self.offset), unit, si)


@dataclass(frozen=True)
class ChannelMap:
    """The mapped channels by canonical name, and the file they came from.

    ``text`` says how a text table is written; columns in ``ignore`` are not taken by their name;
    ``dbc`` files say what is in the frames of a bus.
    """

    where: str
    channels: dict[str, Mapping]
    text: TextFormat = LOOKED
    ignore: tuple[str, ...] = ()
    dbc: tuple[Path, ...] = ()
