"""`brake-cal map`: propose a channel map for a log of foreign names."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from cli.command import FAILED, UNREADABLE, Answer, command
from cli.console import complain, emit, misuse, this_run
from cli.options import argument, channel_map, option
from cli.outputs import sealed, write_file

if TYPE_CHECKING:
    from calib.logs.channel_map import ChannelMap


def _sources(texts: list[str]) -> dict[str, str]:
    for text in texts:
        if "=" not in text:
            raise misuse(f"{text!r} is not CHANNEL=NAME")
    pairs = (text.partition("=") for text in texts)
    return {channel.strip(): name.strip() for channel, _, name in pairs}


@command("brake-cal map sample_logs/sedan/ramp_wet_asphalt.csv --out map.toml")
def map_(
    log: Path = argument("log of foreign names", "LOG"),
    *,
    take: dict[str, str] = option(
        "Source of a channel; empty: none.", "CHANNEL=NAME", typed=list[str], make=_sources
    ),
    radius: list[float] = option(
        "Radius [m] for wheel speeds in km/h; twice, of front and rear.", "M", min=0.1, max=1.0
    ),
    channel_map: "ChannelMap | None" = channel_map(
        "Its file format and DBC; not that of the settings."
    ),
    out: Path | None = option("Map file to write.", "M.toml", writes="map"),
) -> Answer:
    """Propose a channel map for a log of foreign names.

    By names, units and physics. Prints the map on stdout and the reasons on stderr. Where something
    is ambiguous it lists the candidates, writes no map and ends with 3. It ends with 1 if the log
    lacks what every log needs, such as the pressure.
    """
    from dataclasses import asdict

    from calib.logs.formats import as_table
    from calib.logs.read import open_log
    from calib.show.facts import Facts
    from calib.suggest.propose import suggest, to_lines, to_toml, tried

    if len(radius) > 2:
        raise misuse(f"{len(radius)} radii; one, or one of front and one of rear", "--radius")
    radii = (radius[0], radius[-1]) if radius else None
    with open_log(log, channel_map) as opened:
        source = as_table(opened.source, str(log))
        suggested = suggest(source, str(log), user_specified=take, radii=radii)
    proposal = tried(suggested, log, channel_map)
    toml = to_toml(proposal, channel_map, None if out is None else out.absolute().parent)
    certain = not proposal.doubts and bool(proposal.proposals)
    if certain and out is not None:
        write_file(out, sealed(toml), kind="map")
    if not this_run().quiet:
        emit(Facts(rows=list(to_lines(proposal))), sys.stderr)
    for doubt in proposal.doubts:
        complain(f"{doubt.channel}: {doubt}")
    if not proposal.doubts and not certain:
        complain(f"{log}: no column is a channel; name them: --take CHANNEL=NAME")
    if certain and proposal.missing:
        complain(f"{log}: {', '.join(proposal.missing)} missing: no table can be made of this log")
    record = asdict(proposal)
    record["left"] = record.pop("unused")
    document = {"certain": not proposal.doubts, **record, "toml": toml if certain else None}
    text = toml.rstrip("\n") if certain and out is None else ""
    return Answer(document, text, FAILED * bool(proposal.missing) if certain else UNREADABLE)
