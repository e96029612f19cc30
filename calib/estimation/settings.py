"""The gates of a validation in one record; each number with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True)
class _ValidationSettings:
    """Each is named after what it decides; the comments name the file."""

    # axles.py
    axles_reversed: float = 0.5
    """Share of the table's rise of eta by which eta must fall for the axles to count as
    reversed."""
    eta_rises: float = 1e-3
    """Rise of eta by the table [1] from which its sign alone tells the axles: usual cars make 2e-3,
    and radii, tyres and pads of the day move it by less than a half of that."""
    ratio_kept: float = 0.1
    """Change of the pads' ratio since the ramp (logarithm) up to which they are the same pads."""
    ratio_apart: float = 0.25
    """Change of the pads' ratio with the axles exchanged (logarithm) that takes two mistakes at
    once: of swapped stops of good cars it is 0.2 at most. Light braking on another road than that
    of the ramp made odds of 13 to 32 for axles that were right, with changes of 0.3 to 0.7."""
    axles_doubt: float = -3.0
    """Logarithm of the odds of swapped wheel speeds from which they are named: one in twenty."""
    axles_sure: float = 15.0
    """The same from which no sample is valid. Swapped wheel speeds of the cars of the tests have 13
    to 63, weak front pads -5 and less (`tests/estimation/test_axles.py`)."""
    brakes_kept: float = 0.88
    """Brakes over those of the ramp [1] above which front pads are not so weak that eta stays flat,
    as it would in a bend with such pads."""
    at_limit: float = 0.1
    """Share of the braked samples with a wheel at its limit past which nothing is weighed: the
    scenarios know no wheel that locks."""


SETTINGS = _ValidationSettings()
