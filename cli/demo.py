"""`brake-cal demo`: the whole program on the sample logs."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cli.console import emit, emit_json, say
from cli.grid import grid
from cli.options import Json, example, out_folder
from cli.outputs import ready_folder

if TYPE_CHECKING:
    from rich.table import Table as Grid

    from calib.help.demo import SectionFive, SectionFour, Story

EPILOG = example("brake-cal demo", "brake-cal demo --out somewhere")
FOLDER = Path("brake-cal-demo")


def demo(
    out: Annotated[Path, out_folder("Folder for all files.")] = FOLDER,
    json: Json = False,
) -> None:
    """Try all steps on the sample logs.

    Checks, fits, validates and draws them, and prints the paper's two studies. At the end it
    diagnoses a car with a hidden effect: the gap, the effect, the gap with it. All files go into
    one folder: the sample logs, the store, results and figures.
    """
    from calib.diagnosis.written.document import to_dict
    from calib.help.demo import hidden_story, run, section_five, section_four

    ready_folder(out)
    out.mkdir(parents=True, exist_ok=True)
    outcomes = run(out, say)
    by_folder = {outcome.study.folder: outcome for outcome in outcomes}
    four = section_four(by_folder["simulation_study"])
    five = section_five(by_folder["sedan"])
    story = hidden_story(out, say)
    if json:
        emit_json(
            {
                "schema": 1,
                "folder": out,
                "diagnosis": to_dict(story.found),
                "tables": [outcome.stored.id for outcome in outcomes],
                "section_4": four,
                "section_5": five,
            }
        )
        return
    emit("\nSection IV: pads are 0.4, the vehicle file says 0.5 and 0.6")
    emit(_four(four))
    emit("\nSection V: stops of the reference car, nominal pads 0.38")
    emit(_five(five))
    emit("The last column is near 1 for any table; it validates nothing.")
    emit("\nA car with an effect that its vehicle file does not have")
    emit(_hidden(story))
    emit(f"\ntables    {out / 'tables'}")
    emit(f"results   {out / 'results'}")
    emit(f"figures   {out / 'figures'}")
    emit(f"diagnosis {out / 'diagnosis' / 'report.html'}")


def _hidden(story: "Story") -> str:
    """The verdict, the gap, and the gain in the agreement of the pads."""
    from calib.show.diagnosis import facts

    pads = [
        f"{100 * a.spread_f:.1f} % front, {100 * a.spread_r:.1f} % rear"
        for a in (story.blind, story.told)
    ]
    return "\n".join(
        (
            facts(story.found, "").headline,
            f"Pads of the stops differ by up to {pads[0]};",
            f"with a table that accounts for it, by {pads[1]}.",
        )
    )


def _four(rows: "list[SectionFour]") -> "Grid":
    heads = ("final front", "final rear", "torque error [N m]", "better by")
    table = grid("method", *heads, right=heads)
    nominal = next(row.torque_rms for row in rows if row.method == "nominal")
    for row in rows:
        table.add_row(
            row.method,
            f"{row.final_f:.3f}",
            f"{row.final_r:.3f}",
            f"{row.torque_rms:.1f}",
            f"{nominal / row.torque_rms:.1f} x",
        )
    return table


def _five(rows: "list[SectionFive]") -> "Grid":
    heads = ("front pads", "rear pads", "sum, nominal pads", "sum, compensated")
    table = grid("stop", *heads, right=heads)
    for row in rows:
        table.add_row(
            row.log,
            f"{row.pads_f:.3f} +- {row.width_f:.3f}",
            f"{row.pads_r:.3f} +- {row.width_r:.3f}",
            f"{row.sum_nominal:.2f}",
            f"{row.sum_compensated:.2f}",
        )
    return table
