"""`brake-cal check`: what a log contains, and for what it can be used."""

from pathlib import Path
from typing import TYPE_CHECKING

from cli.command import FAILED, UNREADABLE, Answer, command
from cli.console import complain, progress
from cli.logs import named, opened, tell
from cli.options import Map, logs

if TYPE_CHECKING:
    from calib.plausibility.check import Findings


@command("brake-cal check sample_logs/sedan/*.csv")
def check(logs: list[Path] = logs("logs to check"), *, channel_map: Map) -> Answer:
    """Say for what each log can be used, as far as can be told without a vehicle file.

    One line for each; -v shows what the log contains as well. Exit code 1 if a log is usable for
    nothing, 3 if one cannot be read.
    """
    from calib.base.errors import InputError
    from calib.plausibility.check import to_dict
    from calib.show.check import facts

    found: list[Findings] = []
    failed: list[tuple[Path, InputError]] = []
    with progress() as step:  # a log that cannot be read does not stop the check of the others
        for i, (path, name) in enumerate(zip(logs, named(logs), strict=True)):
            step(f"reading {name.name}", i, len(logs))
            try:
                found.append(_findings(path, channel_map))
            except InputError as error:
                failed.append((path, error))
    for _, wrong in failed:
        complain(str(wrong))
    document = {
        **({"error": failed[0][1].to_dict()} if failed else {}),
        "logs": [to_dict(f) for f in found],
        "unreadable": [{"source": path, "error": str(wrong)} for path, wrong in failed],
    }
    useless = FAILED * (not all(one.usable for one in found))
    return Answer(document, facts(found), UNREADABLE if failed else useless)


def _findings(path: Path, mapping: Map) -> "Findings":
    from calib.logs.read import read_opened
    from calib.plausibility.check import check as look_at
    from calib.run.copies import computed_channels

    with opened(path, mapping) as source:
        log = read_opened(source, mapping, require=())
    tell(log)
    return look_at(log, computed_channels(log, source.source))
