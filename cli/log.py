"""`brake-cal log`: look at logs, cut them, convert them."""

from cli import log_convert, log_cut, log_view
from cli.group import command_group

app = command_group(
    "Logs: look at them, cut a part, convert them.",
    "brake-cal log view sample_logs/sedan/coast.csv --out coast.html",
)

app.command(epilog=log_view.EPILOG)(log_view.view)
app.command(epilog=log_cut.EPILOG)(log_cut.cut)
app.command(epilog=log_convert.EPILOG)(log_convert.convert)
