"""Where a table that was made of others comes from, for the commands that show tables."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from calib.table.table import Table


def origin_facts(table: "Table") -> list[tuple[str, str]]:
    """Name and value of what a table was made of, how its cars differ, what was set by hand."""
    from calib.store.figures import mean_figures

    return [
        *(("parent", f"{p.id} ({p.digest[:12]})") for p in table.provenance.parents),
        *(
            (f"spread of {one.name}", f"{100.0 * one.between:.2f} % between the cars, one sigma")
            for one in mean_figures(table)
        ),
        *(("by hand", str(one)) for one in table.by_hand),
    ]
