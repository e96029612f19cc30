"""The proposed channel map of a foreign log: proposals, doubts and unused columns."""

from dataclasses import dataclass

from calib.logs.channel_map import Mapping

SURE, LIKELY = "sure", "likely"
"""Sure: name, unit and physics agree. Likely: one is missing, and none contradicts."""


@dataclass(frozen=True)
class Proposal:
    """Source of one channel, how ``sure`` it is, and the ``reasons`` in words."""

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

    def __str__(self) -> str:
        names = f": {', '.join(self.candidates)}" if self.candidates else ""
        return f"{self.why}{names}; {self.do}"


@dataclass(frozen=True)
class Suggestion:
    """Result of `calib.suggest.propose.suggest`.

    Attributes
    ----------
    log : path of the log.
    proposals : what is proposed, in the order of `calib.base.names.CHANNELS`.
    doubts : questions to the user; a map is written only if there are none.
    missing : required channels that this log does not have, with the reason.
    left : columns that are not used, with the reason.
    ignore : columns that have the name of a channel but another content.
    """

    log: str
    proposals: tuple[Proposal, ...]
    doubts: tuple[Doubt, ...]
    missing: dict[str, str]
    left: dict[str, str]
    ignore: tuple[str, ...]
