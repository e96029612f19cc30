"""A suggestion is tried before it is believed: the log is read with the proposed map."""

from dataclasses import replace
from pathlib import Path

from calib.base.errors import BrakeCalError
from calib.logs.channel_map import ChannelMap
from calib.logs.read import read_log
from calib.suggest.proposal import LIKELY, Doubt, Suggestion


def tried(found: Suggestion, path: Path, read_with: ChannelMap | None = None) -> Suggestion:
    """The suggestion, with a doubt if the log cannot be read with it.

    ``read_with`` is the map that the log was opened with: its file format and DBC are used. A
    suggestion with doubts has no map yet, and is returned as it is.
    """
    if found.doubts or not found.proposals:
        return found
    channels = {proposal.channel: proposal.mapping for proposal in found.proposals}
    begun = read_with or ChannelMap(str(path), {})
    proposed = replace(begun, where="the proposed map", channels=channels, ignore=found.ignore)
    try:
        read_log(path, proposed, require=tuple(channels))
    except BrakeCalError as error:
        do = "correct the log, or choose other columns: --take CHANNEL=NAME"
        doubt = Doubt("map", (), f"the log cannot be read with it: {error}", do)
        unsure = tuple(replace(proposal, sure=LIKELY) for proposal in found.proposals)
        return replace(found, proposals=unsure, doubts=(doubt,))
    return found
