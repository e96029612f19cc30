"""Tables made before the maps: read, verified, shown and exported, but no longer estimated with."""

from collections.abc import Mapping

from calib.base.errors import OlderTable
from calib.table.table import Table


def require_maps(tables: Mapping[str, Table]) -> None:
    """Raise OlderTable for those of ``tables``, by their names, that have no maps.

    Figures of two generations of the estimator are not of one kind: nothing mixes them.
    """
    older = {name: table for name, table in tables.items() if table.level_map is None}
    if older:
        raise OlderTable(
            f"{', '.join(older)}: made by an older program, without the maps that estimate",
            do="fit again, with `brake-cal fit` and the logs of these SHA-256",
            lines=tuple(
                f"{name}: {log.role} {log.name} {log.digest}"
                for name, table in older.items()
                for log in table.provenance.logs
            ),
        )
