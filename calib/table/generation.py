"""Which generation a table is of: those of before have no maps, and no estimate is made of them."""

from calib.base.errors import StoreError
from calib.table.table import Table


def require_maps(table: Table, where: object = None) -> None:
    """Raise StoreError for a table without maps, with what it was made of; ``where`` names it.

    Such a table is shown, verified and exported as it is.
    """
    if None not in (table.map, table.level_map, table.draws):
        return
    made_of = table.provenance
    parents = [(one.id, one.digest) for one in made_of.parents]
    raise StoreError(
        f"was made by {made_of.program} and has no maps, which estimates rest on",
        where=table.name if where is None else where,
        expected="a table with maps",
        do="fit again, with `brake-cal fit`, from",
        lines=tuple(
            f"{name}, SHA-256 {digest}"
            for name, digest in [(one.name, one.digest) for one in made_of.logs] + parents
        ),
    )
