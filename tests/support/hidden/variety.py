"""How the logs of a case are driven and recorded: which runs, how often sampled, how loud, on what.

A case of twelve runs at 200 Hz is one of many. A user has three logs or forty, of a logger at 40 Hz
or 1 kHz, with quiet or loud sensors, and some of them after a change of pads or on another road.
"""

from dataclasses import dataclass

import numpy as np

from tests.support.hidden.manoeuvres import CALIBRATION, HOLDOUT


@dataclass(frozen=True)
class Ground:
    """What a run is driven with: factor on the pads of both axles, on the stiffness [1]; ``grade``
    of its road, rise over run, which the accelerometer feels."""

    pad_scale: tuple[float, float] = (1.0, 1.0)
    stiffness: float = 1.0
    grade: float = 0.0


@dataclass(frozen=True)
class Variety:
    """Runs of both parts, sample rate [Hz], factor on the noise [1], what each run is driven on.

    A run's name is a manoeuvre, with a number behind a colon where it is driven more than once.
    """

    calibration: tuple[str, ...] = CALIBRATION
    holdout: tuple[str, ...] = HOLDOUT
    rate: float = 200.0
    noise: float = 1.0
    grounds: tuple[Ground, ...] = (Ground(),)

    def ground(self, index: int) -> Ground:
        """The ground of the run at ``index``, calibration before hold-outs."""
        return self.grounds[index % len(self.grounds)]


FEW = (("coast", "ramp", "step_low"), ("stop_a",))
"""The least that a user drives."""

MANY = (
    tuple(f"{name}:{i}" for i in range(4) for name in CALIBRATION[:7]),
    tuple(f"{name}:{i}" for i in range(3) for name in HOLDOUT),
)
"""Forty runs."""


def varied(rng: np.random.Generator) -> Variety:
    """Three, twelve or forty logs at 40 Hz to 1 kHz, a quarter to three times the noise."""
    calibration, holdout = (FEW, (CALIBRATION, HOLDOUT), MANY)[int(rng.integers(3))]
    rate = float(rng.choice([40.0, 50.0, 100.0, 200.0, 500.0, 1000.0]))
    return Variety(calibration, holdout, rate, float(rng.choice([0.25, 1.0, 3.0])))


def unlike(rng: np.random.Generator) -> Variety:
    """Each run with pads and tyres of its own, by 1 to 3 %, and half of the cases on own slopes."""
    count = len((*CALIBRATION, *HOLDOUT))
    pads, tyres = rng.uniform(0.01, 0.03, 2)
    slope = rng.uniform(0.008, 0.02) * (rng.random() < 0.5)
    grounds = tuple(
        Ground(
            (float(np.exp(pads * rng.normal())), float(np.exp(pads * rng.normal()))),
            float(np.exp(tyres * rng.normal())),
            grade=float(slope * rng.normal()),
        )
        for _ in range(count)
    )
    return Variety(grounds=grounds)
