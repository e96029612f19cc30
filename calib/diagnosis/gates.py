"""The gates of a diagnosis in one record; each number with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True)
class _DiagnosisGates:
    """Each is named after what it decides; the comments name the file."""

    # runs/gates.py
    stronger: float = 2.5
    """Brakes of a log over those of the others [1], or the inverse, that no pads make: soaked ones
    lose half, and the effects of the catalogue, three at a time, moved a log by 1.6 at most."""

    # runs/sides.py
    sides_settled: float = 0.3
    """Time before the first braking that is left out [s]: means over a lead-in end before the
    bite."""
    sides_slow: float = 10.0
    """Wheel speed [rad/s], about 3 m/s, below which the sensors are too inexact."""
    sides_least: float = 0.5
    """Seconds of rolling, of all logs together, from which the sides are compared."""

    # proof/remainder.py
    remainder_block: float = 0.5
    """Span of a mean [s]: several times the correlation time of a road's noise, a part of a
    stop."""
    remainder_least: float = 3.0
    """Rms of the lasting errors over the noise of the sensors from which something is left [1].
    With nothing hidden, on a plant with other forms of tyre than here, up to 1.3 is left; see
    tests/studies/naming.py."""
    remainder_sure: float = 5.0
    """Least distance of the sum of squares from that of noise, in its standard deviations."""
    remainder_farthest: float = 2.0
    """Largest move along a direction of the parameters' covariance, in standard deviations: 95
    %."""

    # proof/oscillation.py
    over_slower: float = 2.0
    """Least power of a peak over that of the slower lines beside which it stands."""
    over_slowest: float = 3.0
    """Least power of a peak over that of the first line, at 0.25 Hz. What every application leaves,
    as a lag does, is in both; a swing of 0.5 Hz or more has at most a fifth there."""


GATES = _DiagnosisGates()
