"""What was found out of a foreign log: what is which channel, how sure that is, and what is not."""

from dataclasses import dataclass

from calib.logs.channel_map import Mapping

SURE, LIKELY = "sure", "likely"
"""Sure: name, unit and physics agree. Likely: one of them is silent, none speaks against it."""


@dataclass(frozen=True)
class Proposal:
    """One channel's origin, how ``sure`` it is, and the ``reasons`` in words."""

    channel: str
    mapping: Mapping
    sure: str
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class Doubt:
    """A question that only the user can answer: ``candidates`` for ``channel``, and ``why``."""

    channel: str
    candidates: tuple[str, ...]
    why: str
    do: str


@dataclass(frozen=True)
class Suggestion:
    """The outcome.

    Attributes
    ----------
    log : the file that was looked at.
    proposals : what is proposed, in the order of the page of names.
    doubts : what has to be asked; a map is only written where there are none.
    missing : channels that every log must have and that this one does not, with the reason.
    left : columns that are not taken, with the reason.
    ignore : columns that bear the name of a channel and are none.
    """

    log: str
    proposals: tuple[Proposal, ...]
    doubts: tuple[Doubt, ...]
    missing: dict[str, str]
    left: dict[str, str]
    ignore: tuple[str, ...]
