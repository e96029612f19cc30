"""`brake-cal diagnose`: name the effect that the model of a car lacks."""

from pathlib import Path
from typing import Any

from typer.core import TyperCommand

from cli.command import Answer, command
from cli.console import progress, say
from cli.logs import read_all
from cli.options import Car, Map, OwnEffects, Workers, argument, option
from cli.outputs import check_folder, stems_of, writing


class _ManyHoldouts(TyperCommand):
    """A command whose ``--holdout`` takes all logs up to the next option, as a shell's * gives."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Repeat ``--holdout`` before each of its logs, then parse as usual."""
        repeated: list[str] = []
        is_holdout = False
        for word in args:
            if word.startswith("-"):
                is_holdout = word == "--holdout"
            elif is_holdout and repeated[-1] != "--holdout":
                repeated.append("--holdout")
            repeated.append(word)
        return super().parse_args(ctx, repeated)


@command(
    "brake-cal diagnose sample_logs/hidden/case_0/calibration/coast.parquet "
    "sample_logs/hidden/case_0/calibration/ramp.parquet "
    "--holdout sample_logs/hidden/case_0/holdout/stop_a.parquet "
    "--vehicle sample_logs/hidden/case_0/vehicle.toml --out found",
    cls=_ManyHoldouts,
)
def diagnose(
    logs: list[Path] = argument("Logs to search in.", "LOG..."),
    *,
    vehicle: Car,
    out: Path = option("Write diagnosis, model and report here.", "DIR", writes="folder"),
    holdout: list[Path] = option("Logs to confirm the effect on.", "LOG...", "--holdout"),
    effect: OwnEffects,
    channel_map: Map,
    workers: Workers,
) -> Answer:
    """Name the effect that the model of a car lacks.

    The answer says where simulation and measured runs disagree, adds the effect, and confirms it on
    the logs of --holdout. Exit code 0, or 130 if stopped.
    """
    from calib.base.plain import counted
    from calib.base.processes import cores, parallel_map
    from calib.car.effects.catalogue import with_own
    from calib.diagnosis.diagnose import diagnose as find
    from calib.diagnosis.diagnosis import files_of, to_dict, write_folder
    from calib.show.facts import facts_of
    from calib.show.html import page_of

    files = files_of(stems_of(holdout, "--holdout"))
    check_folder(out, [file.as_posix() for file in files])
    car = with_own(vehicle, effect)
    processes = workers or min(cores(), 8)
    if car.effects.user_defined:  # the function of such an effect exists in this process alone
        processes = 1
    with parallel_map(processes, "calib.diagnosis.diagnose") as run_parallel:
        with progress() as step:
            runs = read_all([*logs, *holdout], channel_map, step)
        say(f"searching {counted(len(logs), 'log')}, confirming on {len(holdout)}")
        with progress() as step:
            diagnosis = find(car, runs[: len(logs)], runs[len(logs) :], step, run_parallel)
    with progress("drawing the report"):
        page = page_of(facts_of(diagnosis))
    with writing(out):
        write_folder(diagnosis, page, out)
    say(f"wrote {out}: diagnosis.json, model.toml, report.html, replays in sim/")
    return Answer(to_dict(diagnosis), diagnosis, out=out)
