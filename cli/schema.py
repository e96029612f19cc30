"""`brake-cal schema`: the JSON Schema of a file that is read, or of a document that is written."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import emit, emit_json
from cli.options import Json, example

if TYPE_CHECKING:
    from calib.base.record import Section

EPILOG = example("brake-cal schema", "brake-cal schema vehicle", "brake-cal schema fit-json")


def _names() -> list[str]:
    """Every NAME."""
    from calib.help.documents import documents

    return [*SCHEMAS, *documents()]


def schema(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="NAME",
            help="One kind of file; if not given, the list.",
            autocompletion=_names,
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Print the JSON Schema of a file or a document.

    Without a NAME it lists those that there are, in draft 2020-12. Of a file that is read it gives
    keys, units and ranges. Conditions between two values, such as a disc that fits into the wheel,
    are checked by the program only. Of a document that --json prints or a command writes it gives
    the keys of the first level.
    """
    from calib.help.documents import documents

    if name is None:
        _list(json)
    elif name in SCHEMAS:
        from calib.base.record import json_schema

        emit_json(json_schema(SCHEMAS[name][1]()))
    elif name in documents():
        emit_json(documents()[name].schema)
    else:
        from calib.base.toml import did_you_mean

        hint = did_you_mean(name, _names()) or "'brake-cal schema' lists the known ones"
        raise typer.BadParameter(f"unknown file {name!r}; {hint}", param_hint="NAME")


def _list(json: bool) -> None:
    from calib.help.documents import documents

    files = {name: about for name, (about, _) in SCHEMAS.items()}
    written = {name: one.title.replace("`", "") for name, one in documents().items()}
    if json:
        emit_json({"schema": 1, "files": files, "documents": written})
        return
    width = max(map(len, [*files, *written]))
    emit("\n".join(f"{name:<{width}}  {about}" for name, about in (files | written).items()))


def _vehicle() -> "type[Section]":
    from calib.car.vehicle_file import VehicleFile

    return VehicleFile


def _model() -> "type[Section]":
    from calib.car.model_file import ModelFile

    return ModelFile


def _limits() -> "type[Section]":
    from calib.estimation.limits_file import limits_schema
    from calib.estimation.metrics import METRICS as OF_STOPS
    from calib.line.gauge.study import known_limits
    from calib.line.station.metrics import METRICS as OF_CAR

    return limits_schema({*OF_STOPS, *OF_CAR, *known_limits()})


def _channel_map() -> "type[Section]":
    from calib.logs.channel_map_file import ChannelMapFile

    return ChannelMapFile


def _table() -> "type[Section]":
    from calib.store.record_file import RecordFile

    return RecordFile


def _summary() -> "type[Section]":
    from calib.store.summary_file import SummaryFile

    return SummaryFile


def _vehicle_facts() -> "type[Section]":
    from calib.car.facts_file import VehicleFactsFile

    return VehicleFactsFile


def _error() -> "type[Section]":
    from calib.base.record import ErrorFile

    return ErrorFile


def _settings() -> "type[Section]":
    from calib.base.settings_file import SettingsFile

    return SettingsFile


SCHEMAS: "dict[str, tuple[str, Callable[[], type[Section]]]]" = {
    "vehicle": ("vehicle.toml: masses, lengths and brakes of a car", _vehicle),
    "model": ("model.toml: pads, tyre, effects and roads of a simulation", _model),
    "limits": ("limits.toml: the allowed range of each metric", _limits),
    "channel-map": ("map.toml: which column of a foreign log is which channel", _channel_map),
    "settings": ("brake-cal.toml: what options say that are not given", _settings),
    "table": ("record.json: a stored table without its curves", _table),
    "summary": ("summary.json of a validation, as far as an export reads it", _summary),
    "vehicle-facts": ("what `vehicle show --json` prints of a vehicle file", _vehicle_facts),
    "error": ("what a command with --json prints where it ends with an error", _error),
}
"""Kinds of files: their content and their schema."""
