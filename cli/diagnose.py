"""`brake-cal diagnose`: where a model and the measured runs disagree, and the missing effect."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperCommand

from calib.base.plain import counted
from calib.diagnosis.gates import GATES
from cli.console import emit_facts, emit_json, say, stages, warn
from cli.inputs import channel_map_of, with_own_effects
from cli.logs import named, read
from cli.options import Json, Map, OwnEffects, Workers, example, needed_vehicle, out_folder
from cli.outputs import ready_folder, refuse_overwriting, stems_of, writing
from cli.stop import stoppable

if TYPE_CHECKING:
    pass

EPILOG = example(
    "brake-cal diagnose sample_logs/hidden/case_0/calibration/coast.parquet "
    "sample_logs/hidden/case_0/calibration/ramp.parquet "
    "--holdout sample_logs/hidden/case_0/holdout/stop_a.parquet "
    "--vehicle sample_logs/hidden/case_0/vehicle.toml --out found"
)
HOLDOUT = "--holdout"


class Greedy(TyperCommand):
    """A command whose ``--holdout`` takes all logs up to the next option, as from a shell's *."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Repeat ``--holdout`` before each of its logs, then parse as usual."""
        repeated: list[str] = []
        held = False
        for arg in args:
            if arg.startswith("-"):
                held = arg == HOLDOUT
            elif held and repeated[-1] != HOLDOUT:
                repeated.append(HOLDOUT)
            repeated.append(arg)
        return super().parse_args(ctx, repeated)


def diagnose(
    logs: Annotated[list[Path], typer.Argument(metavar="LOG...", help="Logs to search in.")],
    *,
    vehicle: Annotated[Path, needed_vehicle("Vehicle file with datasheet values")],
    out: Annotated[Path, out_folder("Write diagnosis, model and report here.")],
    holdout: Annotated[
        list[Path] | None,
        typer.Option(HOLDOUT, metavar="LOG...", help="Logs to confirm it on."),
    ] = None,
    effect: OwnEffects = None,
    channel_map: Map = None,
    workers: Workers = None,
    json: Json = False,
) -> None:
    """Name the effect that the model of a car lacks.

    It says where simulation and measured runs disagree, adds the effect, and confirms it on the
    logs of --holdout. Logs that look like a mistake are refused before the search: a hold-out that
    is a copy, swapped wheel speeds, a pressure of another run. Exit code 0, or 130 if stopped by
    Ctrl-C or SIGTERM.
    """
    from calib.base.processes import cores, side_by_side
    from calib.car.vehicle_file import read_vehicle
    from calib.diagnosis.diagnose import diagnose as find
    from calib.diagnosis.written.document import text_of, to_dict
    from calib.diagnosis.written.folder import files_of, write_folder
    from calib.show.diagnosis import facts
    from calib.show.diagnosis_page import report as report_of
    from calib.show.html import page_of

    kept = holdout or []
    stems = stems_of(named([*logs, *kept])[len(logs) :], HOLDOUT)
    files = files_of(stems)
    ready_folder(out, [file.as_posix() for file in files])
    refuse_overwriting((out / file for file in files), [*logs, *kept], [vehicle, *(effect or [])])
    car = with_own_effects(read_vehicle(vehicle), effect)
    mapping = channel_map_of(channel_map)
    paths, runs = [*logs, *kept], []
    # A function of one's own acts in one process only.
    count = 1 if car.effects.own else workers or min(cores(), GATES.refined)
    with stoppable("stopped; nothing was written"):
        with side_by_side(count, "calib.diagnosis.diagnose") as mapped:
            with stages() as tell:
                for i, path in enumerate(paths):
                    tell(f"reading {path.name}", i, len(paths))
                    runs.append(read(path, mapping))
            say(f"searching {counted(len(logs), 'log')}, confirming on {len(kept)}")
            with stages() as tell:
                found = find(car, runs[: len(logs)], runs[len(logs) :], tell, mapped)
        with stages() as tell:
            tell("drawing the report", 0, 1)
            report = page_of(report_of(found, car.name))
        with writing(out):
            write_folder(found, text_of(found), report, out)
    say(f"wrote {out}: diagnosis.json, model.toml, report.html, replays in sim/")
    warn(found.warnings)
    if json:
        emit_json(to_dict(found))
    else:
        emit_facts(facts(found, car.name))
