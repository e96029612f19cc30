"""Where a table comes from: its logs, the program, and the settings that its numbers rest on."""

from collections.abc import Mapping, Sequence

from calib.base.program import PROGRAM
from calib.car.braking import BITE
from calib.car.tyre_file import TyreFile
from calib.logs.log import Log
from calib.model.roller_bench import RollerBench
from calib.model.settings import SETTINGS
from calib.model.sort_logs import Prepared
from calib.run.blocks import BLOCK
from calib.run.same_run import fingerprint_of
from calib.table.table import LogReference, Provenance, Table, TableReference


def provenance(
    roles: Mapping[str, list[Prepared]],
    read: Mapping[tuple[str, str], Log],
    bench: RollerBench | None,
    tyres: Sequence[TyreFile],
    fleet: Mapping[str, Table],
) -> Provenance:
    """The parents of a table.

    ``roles`` the logs of each; ``read`` the same as they were read, by name and digest; ``fleet``
    tables of other cars, by name@version, that the prior rests on.
    """
    logs_read = ((read[log.name, log.digest], role) for role in roles for log, _, _ in roles[role])
    return Provenance(
        logs=(
            *(LogReference(x.name, x.digest, r, x.notes, fingerprint_of(x)) for x, r in logs_read),
            *(LogReference(one.name, one.digest, "bench") for one in [bench] if one),
            *(LogReference(one.name, one.digest, "tyre") for one in tyres),
        ),
        settings={
            "block": BLOCK,
            "bite_pressure": BITE,
            "pads_repeat": SETTINGS.pads_repeat,
            "pad_scatter": SETTINGS.pad_scatter,
        },
        program=PROGRAM,
        parents=tuple(TableReference(id_, table.digest) for id_, table in fleet.items()),
    )
