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
    logs: Mapping[str, list[Prepared]],
    read: Mapping[tuple[str, str], Log],
    bench: RollerBench | None,
    tyres: Sequence[TyreFile],
    fleet: Mapping[str, Table],
) -> Provenance:
    """Return the parents of a table.

    ``logs`` by role; ``read`` the same logs as they were read, by name and digest;
    ``bench`` a run on a roller brake tester; ``tyres`` files of the tyres; ``fleet`` tables of
    other cars, by name@version, that the prior rests on.
    """
    driven = (
        _reference(read[log.name, log.digest], role)
        for role, group in logs.items()
        for log, _, _ in group
    )
    rollers = () if bench is None else (LogReference(bench.name, bench.digest, "bench"),)
    of_tyres = (LogReference(one.name, one.digest, "tyre") for one in tyres)
    return Provenance(
        logs=(*driven, *rollers, *of_tyres),
        settings=settings(),
        program=PROGRAM,
        parents=tuple(TableReference(id_, table.digest) for id_, table in fleet.items()),
    )


def _reference(log: Log, role: str) -> LogReference:
    return LogReference(log.name, log.digest, role, log.notes, fingerprint_of(log))


def settings() -> dict[str, float]:
    """The constants the result rests on."""
    return {
        "block": BLOCK,
        "bite_pressure": BITE,
        "pads_repeat": SETTINGS.pads_repeat,
        "pad_scatter": SETTINGS.pad_scatter,
    }
