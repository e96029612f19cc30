"""What a mean table says of itself in words: its cars, its range, and what no mean shrinks."""

from collections.abc import Sequence

from calib.store.parents import CAR_MARKS
from calib.store.version import Stored

SHARED = (
    "what all cars share is in the mean as it is in each of them: mass, geometry and brakes of the "
    "vehicle file, the surface of the track, sensors that are wrong in one way, the method; its "
    "bands hold that, more cars do not shrink it"
)

FEW = 5
"""Number of cars below which the spread between them is hardly known."""


def remarks(parents: Sequence[Stored]) -> tuple[str, ...]:
    """Remarks of the mean table."""
    ends = {p.id: float(p.table.difference.eta[-1]) for p in parents}
    shortest, longest = min(ends, key=lambda i: ends[i]), max(ends, key=lambda i: ends[i])
    said = [
        f"mean of {len(parents)} cars by a random-effects model (REML, Hartung-Knapp); bands and "
        "sigmas are those of one more car of the model",
        f"curves end at eta {ends[shortest]:.5f}, where {shortest} ends; {longest} goes to "
        f"{ends[longest]:.5f}",
        SHARED,
    ]
    if len(parents) < FEW:
        said.append(
            f"{len(parents)} cars say little of how cars differ: the bands use Student's t with "
            f"{len(parents) - 1} degree{'s' * (len(parents) > 2)} of freedom"
        )
    unknown = [p.id for p in parents if not _known(p)]
    if unknown:
        said.append(
            f"taken as different cars, without a serial number or VIN: {', '.join(unknown)}"
        )
    settings = [p.table.provenance.settings for p in parents]
    if any(s != settings[0] for s in settings):
        said.append("the tables were fitted with different settings; the common ones are kept")
    return tuple(said)


def _known(stored: Stored) -> bool:
    return any(stored.table.provenance.identity.get(mark) for mark in CAR_MARKS)
