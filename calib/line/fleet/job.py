"""The job of a batch: the command and its inputs, the same for every log."""

import hashlib
import json
import pickle
from dataclasses import asdict, dataclass

from calib.base.program import VERSION
from calib.car.vehicle import Vehicle
from calib.estimation.limits import Limit
from calib.line.fleet.command import Command
from calib.logs.channel_map import ChannelMap, DatabaseFile
from calib.logs.read import log_bytes
from calib.table.table import Table


@dataclass(frozen=True)
class Job:
    """A command with its table, vehicle, limits and channel map.

    `validate` needs a table and limits, `fit` a vehicle. Logs are read with ``channel_map``.
    """

    command: Command
    table: Table | None = None
    vehicle: Vehicle | None = None
    limits: tuple[Limit, ...] = ()
    channel_map: ChannelMap | None = None
    version: str = VERSION

    def settings(self) -> dict[str, str]:
        """Settings on which the rows depend besides the logs, each as a word or a digest."""
        return {
            "command": self.command,
            "table": self.table.digest if self.table else "none",
            "vehicle": _digest(asdict(self.vehicle)) if self.vehicle else "none",
            "limits": _digest([asdict(limit) for limit in self.limits]),
            "map": _of_map(self.channel_map) if self.channel_map else "none",
            "program": self.version,
        }

    def packed(self) -> bytes:
        """The job as bytes; a worker unpacks them once."""
        return pickle.dumps(self, protocol=pickle.HIGHEST_PROTOCOL)


def _of_map(mapped: ChannelMap) -> str:
    """Digest of a map and of the content of the files that describe frames."""
    content = asdict(mapped)
    del content["where"]
    content["dbc"] = [_of_file(file) for file in mapped.dbc]
    content["buses"] = [(bus, [_of_file(file) for file in files]) for bus, files in mapped.buses]
    return _digest(content)


def _of_file(file: DatabaseFile) -> tuple[str, str | None]:
    """Digest of the content of a file, and the bus of it that is meant."""
    return hashlib.sha256(log_bytes(file.path, any_format=True)).hexdigest(), file.bus


def _digest(value: object) -> str:
    text = json.dumps(value, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()
