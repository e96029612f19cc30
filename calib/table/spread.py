"""How the cars of one model differ: what a table that is the mean of several cars keeps of them."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Scatter:
    """``between`` standard deviation between cars; ``of_mean`` standard error of their mean.

    ``of_mean`` holds what differs from car to car and from run to run, not what all of them share:
    vehicle file, track, method. It goes with Student's t of `Spread.freedom`.
    """

    between: float
    of_mean: float


@dataclass(frozen=True)
class FleetScatter:
    """Scatter of ``cars`` cars: of D [1] at the rows of the table's D, and of logarithms [1].

    ``pad_level`` of the brake force of both axles per pressure; ``pad_ratio`` of the pads, front
    over rear; ``stiffness`` slip stiffness of the tyres.
    """

    cars: int
    D: tuple[Scatter, ...]
    pad_level: Scatter
    pad_ratio: Scatter
    stiffness: Scatter

    @property
    def freedom(self) -> int:
        """Degrees of freedom of Student's t."""
        return self.cars - 1
