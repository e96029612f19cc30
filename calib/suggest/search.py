"""What is known while the channels of a car are searched among columns."""

from dataclasses import dataclass, field

from calib.base.names import CHANNELS
from calib.base.units import from_si, is_unit, to_si
from calib.logs.channel_map import Mapping
from calib.logs.source import Array
from calib.suggest.columns import ColumnClock, Series

SURE, LIKELY = "sure", "likely"
"""Sure: name, unit and physics agree. Likely: one is missing, and none contradicts."""


@dataclass(frozen=True)
class Proposal:
    """Source of one channel, how ``sure`` it is, and the ``reasons`` in words."""

    channel: str
    mapping: Mapping
    sure: str
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class Doubt:
    """A question that only the user can answer: ``candidates`` for ``channel``, and ``why``."""

    channel: str
    candidates: tuple[str, ...]
    why: str
    do: str

    def __str__(self) -> str:
        names = f": {', '.join(self.candidates)}" if self.candidates else ""
        return f"{self.why}{names}; {self.do}"


def rim_mapping(
    channel: str, source: str, unit: str | None, radius: float | None
) -> Mapping | None:
    """The mapping of a wheel speed that is written as a speed at the rim.

    None for another channel, a unit that is not one of speed, or without the ``radius`` [m].
    """
    if not channel.startswith("omega_") or not unit or radius is None or not is_unit(unit, "m/s"):
        return None
    return Mapping(source, "rad/s", scale=to_si(1.0, unit, "m/s") / radius)


def rim_reason(radius: float) -> str:
    """How a speed at the rim became a wheel speed, in words."""
    return f"divided by the given radius of {radius:g} m"


@dataclass
class Search:
    """What is known so far; a column that is proposed or in ``left`` is not looked at again.

    ``gapped`` columns have no value in some rows; ``told`` channels have no proposals but those of
    the user.
    """

    series: list[Series]
    gapped: list[Series]
    left: dict[str, str]
    told: dict[str, str]
    radius: float | None
    proposals: dict[str, Proposal] = field(default_factory=dict)
    doubts: list[Doubt] = field(default_factory=list)
    clock: ColumnClock | None = None

    def free(self) -> list[Series]:
        """Columns that are neither proposed nor refused."""
        taken = {p.mapping.source for p in self.proposals.values()}
        return [s for s in self.series if s.name not in taken and s.name not in self.left]

    def refuse(self, item: Series, why: str) -> None:
        """Leave a column, with the reason."""
        self.left.setdefault(item.name, why)

    def propose(self, channel: str, mapping: Mapping, sure: bool, *reasons: str) -> None:
        """Propose a channel that the user did not give."""
        if channel not in self.told:
            self.proposals[channel] = Proposal(channel, mapping, SURE if sure else LIKELY, reasons)

    def doubt(self, channel: str, candidates: list[Series], why: str, do: str) -> None:
        """Ask about a channel that the user did not give."""
        if channel not in self.told:
            self.doubts.append(Doubt(channel, tuple(s.name for s in candidates), why, do))

    def given(self, channel: str) -> Array | None:
        """The values [SI] of the column that the user gave for a channel, or None."""
        proposal = self.proposals.get(channel)
        source = proposal.mapping.source if proposal else None
        item = next((s for s in self.series if s.name == source), None)
        if proposal is None or item is None:
            return None
        mapping, written = proposal.mapping, item.values
        if mapping.unit is None:
            return written
        # A given unit overrides the file's: undo that conversion, then apply the given one.
        if item.column.unit and item.si not in (None, "?"):
            written = from_si(written, item.column.unit, str(item.si))
        return mapping.to_si(written, mapping.unit, CHANNELS[channel].si)
