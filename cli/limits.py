"""`brake-cal limits`: the documented limits file."""

from pathlib import Path
from typing import Annotated

import typer

from cli.console import say
from cli.options import example

app = typer.Typer(no_args_is_help=True, help="Limits of a car and of its stops.")


@app.command(epilog=example("brake-cal limits init --out line.toml"))
def init(
    out: Annotated[
        Path | None, typer.Option(metavar="L.toml", help="File to write; stdout without.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the file.")] = False,
) -> None:
    """Write every limit with its meaning, unit, default and reason, ready to be edited."""
    from calib.files import write_whole
    from calib.station.limits_file import limits_file

    text = limits_file()
    if out is None:
        typer.echo(text, nl=False)
        return
    if out.exists() and (out.is_dir() or not force):
        what = "is a directory" if out.is_dir() else "exists; --force replaces it"
        raise typer.BadParameter(f"{out} {what}", param_hint="--out")
    try:
        write_whole(out, text.encode())
    except OSError as error:
        raise typer.BadParameter(
            f"{out} cannot be written ({error.strerror})", param_hint="--out"
        ) from error
    say(f"wrote {out}")
