"""`brake-cal vehicle`: write a vehicle file, judge one, show what follows from it."""

import typer

from cli import vehicle_check, vehicle_init, vehicle_show
from cli.options import example

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Vehicle files: write one, judge one, see what follows.",
    epilog=example("brake-cal vehicle check sample_logs/sedan/vehicle.toml"),
)


@app.callback()
def group() -> None:
    """Vehicle files: write one, judge one, see what follows."""


app.command(epilog=vehicle_init.EPILOG)(vehicle_init.init)
app.command(epilog=vehicle_check.EPILOG)(vehicle_check.check)
app.command(epilog=vehicle_show.EPILOG)(vehicle_show.show)
