"""`brake-cal log`: look at logs, cut them, convert them."""

import typer

from cli import log_convert, log_cut, log_view
from cli.options import example

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Logs: look at them, cut a part, convert them.",
    epilog=example("brake-cal log view sample_logs/sedan/coast.csv --out coast.html"),
)


@app.callback()
def group() -> None:
    """Logs: look at them, cut a part, convert them."""


app.command(epilog=log_view.EPILOG)(log_view.view)
app.command(epilog=log_cut.EPILOG)(log_cut.cut)
app.command(epilog=log_convert.EPILOG)(log_convert.convert)
