"""The tuned numbers of a fit in one record; each with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True)
class FitSettings:
    """What a fit takes as given. Those that decide a table's numbers are in its provenance."""

    nominal_odds: float = 9.0
    """Odds that the pads of a calibration run have the ratio of the vehicle file. A ramp with other
    pads than declared is the exception; a clear one (10 % and more) is recognised all the same."""
    pad_tolerance: float = 0.01
    """How exactly pads that are as declared have the declared ratio (standard deviation)."""
    model_error: float = 0.01
    """What the tyre curve itself is off, relative to the slip: about what third-party plants
    show."""
    zero_sigma: float = 0.02
    """Sigma of the zeros of eta and slip of a run: radii agree within 2 %."""
    huber: float = 3.0
    """Residuals past this many sigma count with Huber's weight: few of noise do."""
    min_speed: float = 5.0
    """Below this v [m/s] the clock offset and the noise of v swallow the slip."""
    outlier: float = 4.0
    """Residuals past this many sigma are named: of 500 blocks of noise one in 30 runs has one."""
    flat: float = 0.1
    """Share of its first slope at which eta over z is too flat to be read backwards: there an error
    of eta moves D ten times as far as it should."""
    rows: int = 61
    """Rows of a look-up: linear interpolation between them errs by less than 1e-4 in D."""
    min_count: int = 3
    """Blocks that a cell needs to count as measured: two may be one disturbance."""


SETTINGS = FitSettings()
