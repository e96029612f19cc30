"""`brake-cal tables`: the commands on a store."""

from cli import diff, export, keys, listing, merge, read_back, show, sign, states, verify
from cli.group import command_group

app = command_group(
    "Look at tables, release or reject them, hand them out.", "brake-cal tables list"
)

app.command("list", epilog=listing.LIST)(listing.list_tables)
app.command(epilog=listing.FIND)(listing.find)
app.command(epilog=show.EPILOG)(show.show)
app.command(epilog=states.LOG)(states.log)
app.command(epilog=diff.EPILOG)(diff.diff)
app.command(epilog=verify.EPILOG)(verify.verify)
app.command(epilog=states.RELEASE)(states.release)
app.command(epilog=states.REJECT)(states.reject)
app.command(epilog=states.WITHDRAW)(states.withdraw)
app.command(epilog=keys.EPILOG)(keys.key)
app.command(epilog=sign.EPILOG)(sign.sign)
app.command("export", epilog=export.EPILOG)(export.export_table)
app.command("import", epilog=read_back.EPILOG)(read_back.import_table)
app.command(epilog=merge.EPILOG)(merge.merge)
