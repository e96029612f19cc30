"""Half widths as cells of a table, and what a fit reached of a plan."""

from collections.abc import Sequence

from calib.plan.achieved import Achieved
from calib.show.facts import Facts, Table

WIDTH_HEADS = ("after", "front ± [%]", "rear ± [%]", "total ± [%]")
WIDTHS = "Brake torque is known to so many per cent (95 %)."


def width_cells(widths: Sequence[float], none: str = "not known") -> tuple[str, ...]:
    """Half widths [1] in percent; ``none`` for one that is not known or not asked for."""
    return tuple(f"{100.0 * w:.1f}" if 0.0 < w < 10.0 else none for w in widths)


def achieved_facts(result: Achieved) -> Facts:
    """Planned against achieved."""
    rows = [("planned", *width_cells(result.planned)), ("achieved", *width_cells(result.achieved))]
    word = "as planned" if result.reached else "wider than planned"
    table = Table(WIDTH_HEADS, rows, WIDTHS)
    return Facts("Planned and achieved", word, tables=[table], notes=result.reasons)
