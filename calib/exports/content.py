"""The bare numbers of a data set: what is compared when a file comes back from a tool."""

import hashlib
from dataclasses import dataclass

Numbers = tuple[float, ...]


@dataclass(frozen=True)
class Content:
    """The bare numbers by label: shared axes, scalars, and ``grids``: curves and maps.

    A grid has its axes, the slowest first, and its values.
    """

    axes: dict[str, Numbers]
    scalars: dict[str, float]
    grids: dict[str, tuple[tuple[Numbers, ...], Numbers]]

    def __len__(self) -> int:
        """Number of the objects."""
        return len(self.axes) + len(self.scalars) + len(self.grids)

    @property
    def checksum(self) -> str:
        """SHA-256 over labels and numbers with all their bits [hex]."""
        lines = [f"scalar {n} {float(v).hex()}" for n, v in sorted(self.scalars.items())]
        lines += [f"axis {n} {_hex(v)}" for n, v in sorted(self.axes.items())]
        for kind, several in (("curve", False), ("map", True)):
            lines += [
                f"{kind} {n} {' by '.join(map(_hex, over))} of {_hex(y)}"
                for n, (over, y) in sorted(self.grids.items())
                if (len(over) > 1) == several
            ]
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def _hex(values: Numbers) -> str:
    return " ".join(v.hex() for v in values)
