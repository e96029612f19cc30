"""Figures of a log by the names that `check --json` and the results of a batch have for them."""

from calib.run.observation import Observation


def figures(seen: Observation) -> dict[str, float | None]:
    """Every figure in SI, see `calib.line.fleet.columns`; None where the log gives none."""
    clock, pressure = seen.clock, seen.sensor("p_mc")
    zero = seen.axles.front_rear if seen.axles else None
    return {
        "samples": clock.samples,
        "duration": clock.duration,
        "rate": clock.rate,
        "jitter": clock.jitter,
        "gaps": len(clock.gaps),
        "brakings": len(seen.events),
        "lead_in": seen.lead_in,
        "coasting": seen.coasting,
        "speed_max": seen.speed,
        "deceleration_max": seen.z,
        "pressure_max": pressure.high if pressure else None,
        "eta_zero": zero.value if zero else None,
    }
