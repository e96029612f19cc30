"""Where a table comes from: its logs, the program, and the settings that its numbers rest on."""

from collections.abc import Mapping

from calib import __version__
from calib.fitting.settings import SETTINGS
from calib.fitting.sort_logs import Prepared
from calib.physics.braking import BITE
from calib.signals.blocks import BLOCK
from calib.table.table import LogReference, Provenance


def provenance(
    logs: Mapping[str, list[Prepared]], notes: Mapping[tuple[str, str], tuple[str, ...]]
) -> Provenance:
    """Return the parents of a table; ``logs`` by role, ``notes`` by a log's name and digest."""
    return Provenance(
        logs=tuple(
            LogReference(log.name, log.digest, role, notes[log.name, log.digest])
            for role, group in logs.items()
            for log, _, _ in group
        ),
        settings=settings(),
        program=f"brake-cal {__version__}",
    )


def settings() -> dict[str, float]:
    """The constants the result rests on."""
    return {
        "block": BLOCK,
        "bite_pressure": BITE,
        "model_error": SETTINGS.model_error,
        "form_error": SETTINGS.form_error,
        "form_reach": SETTINGS.form_reach,
        "pads_repeat": SETTINGS.pads_repeat,
        "tyres_repeat": SETTINGS.tyres_repeat,
        "pads_differ": SETTINGS.pads_differ,
        "tyres_differ": SETTINGS.tyres_differ,
        "radii_fall": SETTINGS.radii_fall,
        "pad_scatter": SETTINGS.pad_scatter,
        "tyre_scatter": SETTINGS.tyre_scatter,
        "radius_scatter": SETTINGS.radius_scatter,
    }
