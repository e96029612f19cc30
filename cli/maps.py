"""`brake-cal map`: propose a channel map for a log with other names."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from cli.command import FAILED, UNREADABLE, Answer, command
from cli.console import print_error, print_result, this_run, usage_error
from cli.options import argument, channel_map, option
from cli.outputs import sealed, write_file

if TYPE_CHECKING:
    from calib.logs.channel_map import ChannelMap


def _sources(texts: list[str]) -> dict[str, str]:
    """Return the column of each channel from ``texts`` such as "p_mc=BrkPress [kPa]"."""
    sources = {}
    for text in texts:
        channel, separator, name = text.partition("=")
        if not separator:
            raise usage_error(f"{text!r} is not CHANNEL=NAME, such as 'p_mc=BrkPress [kPa]'")
        sources[channel.strip()] = name.strip()
    return sources


@command("brake-cal map sample_logs/sedan/ramp_wet_asphalt.csv --out map.toml")
def map_(
    log: Path = argument("Log with other names.", "LOG"),
    *,
    take: dict[str, str] = option(
        "Column of a channel; repeatable.", "CHANNEL=NAME", typed=list[str], make=_sources
    ),
    radius: list[float] = option(
        "Radius [m] of wheel speeds in km/h; twice: front, rear.", "M", min=0.1, max=1.0
    ),
    channel_map: "ChannelMap | None" = channel_map(
        "Channel map with file format and DBC; never that of the settings."
    ),
    out: Path | None = option("Map file to write.", "M.toml", writes="map"),
) -> Answer:
    """Propose a channel map for a log with other names.

    The proposal rests on names, units and physics. The map goes to stdout, the reasons to stderr.
    Where a channel is ambiguous, the candidates are listed, no map is written, and the exit code is
    3. The exit code is 1 if the log lacks what every log needs, such as the pressure.
    """
    from dataclasses import asdict

    from calib.logs.formats import as_table
    from calib.logs.read import open_log
    from calib.show.facts import Facts
    from calib.suggest.propose import suggest, to_lines, to_toml, try_on_log

    if len(radius) > 2:
        raise usage_error(f"typed {len(radius)} times; expected once or twice", "--radius")
    radii = (radius[0], radius[-1]) if radius else None
    with open_log(log, channel_map) as opened:
        source = as_table(opened.source, str(log))
        suggested = suggest(source, str(log), user_specified=take, radii=radii)
    proposal = try_on_log(suggested, log, channel_map)
    toml = to_toml(proposal, channel_map, None if out is None else out.absolute().parent)
    has_map = not proposal.doubts and bool(proposal.proposals)
    if has_map and out is not None:
        write_file(out, sealed(toml), kind="map")
    if not this_run().quiet:
        print_result(Facts(rows=list(to_lines(proposal))), sys.stderr)
    for doubt in proposal.doubts:
        print_error(f"{doubt.channel}: {doubt}")
    if not proposal.doubts and not has_map:
        print_error(f"{log}: no column is a channel; name them: --take CHANNEL=NAME")
    if has_map and proposal.missing:
        missing = ", ".join(proposal.missing)
        print_error(f"{log}: {missing} missing; a table needs it: log it, or name it with --take")
    record = {"certain": not proposal.doubts} | asdict(proposal)
    record["left"] = record.pop("unused")  # scripts know the unused columns by this key
    record["toml"] = toml if has_map else None
    if not has_map:
        return Answer(record, "", UNREADABLE)
    text = toml.rstrip("\n") if out is None else ""
    return Answer(record, text, FAILED if proposal.missing else 0)
