"""`brake-cal vehicle`: write a vehicle file, judge one, show what follows from it."""

from cli import vehicle_check, vehicle_init, vehicle_show
from cli.group import command_group

app = command_group(
    "Vehicle files: write one, judge one, see what follows.",
    "brake-cal vehicle check sample_logs/sedan/vehicle.toml",
)

app.command(epilog=vehicle_init.EPILOG)(vehicle_init.init)
app.command(epilog=vehicle_check.EPILOG)(vehicle_check.check)
app.command(epilog=vehicle_show.EPILOG)(vehicle_show.show)
