"""`brake-cal limits`: write the limits file with its explanations."""

from pathlib import Path
from typing import Annotated

import typer

from cli.console import emit_json, say
from cli.group import command_group
from cli.options import Force, Json, example, out_file
from cli.outputs import refuse_folder, refuse_foreign, writing

EXAMPLE = "brake-cal limits init --out line.toml"
app = command_group("Limits of a car and of its stops.", EXAMPLE)


@app.command(epilog=example(EXAMPLE))
def init(
    out: Annotated[Path | None, out_file("File to write; else stdout.", "L.toml")] = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Write a file of all limits, ready to be edited.

    Each with its meaning, unit, default and reason. With --json also as one JSON document on
    stdout.
    """
    from calib.line.station.limits_file import ADVICE, limits_file

    text = limits_file()
    if out is not None:
        _write(text, out, force)
    if json:
        emit_json({"schema": 1, "limits": ADVICE})
    elif out is None:
        typer.echo(text, nl=False)


def _write(text: str, out: Path, force: bool) -> None:
    from calib.base.write import write_whole

    refuse_folder(out)
    refuse_foreign(out, lambda data: data == text.encode(), "the file as it is written", force)
    with writing(out):
        write_whole(out, text.encode())
    say(f"wrote {out}")
