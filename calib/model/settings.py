"""The tuned numbers of a fit in one record; each with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True)
class FitSettings:
    """What a fit takes as given. Those that decide a table's numbers are in its provenance."""

    min_speed: float = 5.0
    """Below this v [m/s] the clock offset and the noise of v swallow the slip."""
    outlier: float = 4.0
    """Residuals past this many sigma are named: of 500 blocks of noise one in 30 runs has one."""
    fastest: float = 0.5
    """Change of the deceleration that the pressure makes [g/s] past which a block takes no part:
    pads, brake lines and the body are then late by as much as eta shows. A ramp to 0.6 g within 3 s
    has 0.2, a pedal that is let go at its end 1 to 3."""
    late: float = 0.15
    """Time [s] for which this is so afterwards."""
    disturbance_of_eta: float = 0.12
    """How far eta stands out from its smooth course, over its range on the ramp, where something
    else acts: a gear shift of 240 N m moves it by a third, a bump by as much as the range."""
    disturbance_of_force: float = 0.03
    """The same of the demanded brake force, over its largest."""
    disturbance_gate: float = 6.0
    """How many times the usual scatter both must stand out."""
    fewest_blocks: int = 20
    """Fewest braked blocks of a ramp in which a disturbance is told, and that must be left of it
    below its top; a fifth of them must be calm before and after a disturbance."""
    disturbance_share: float = 0.3
    """Share of the braked blocks from which on what stands out is no disturbance, but the car."""
    flat: float = 0.1
    """Share of its first slope at which eta over z is too flat to be read backwards: there an error
    of eta moves D ten times as far as it should."""
    rows: int = 61
    """Rows of a look-up: linear interpolation between them errs by less than 1e-4 in D."""
    min_count: int = 3
    """Blocks that a cell needs to count as measured: two may be one disturbance."""


SETTINGS = FitSettings()
