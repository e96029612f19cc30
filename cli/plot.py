"""`brake-cal plot`: draw tables, results and logs into files."""

from pathlib import Path
from typing import TYPE_CHECKING

from cli import options
from cli.command import Answer, command
from cli.console import progress, say, usage_error
from cli.logs import read
from cli.options import argument, option, require_known
from cli.outputs import PAGES, write_page, writing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from calib.logs.log import Log
    from calib.show.result import StoredResult
    from calib.show.sheet import Sheet
    from calib.store.version import Stored


@command(
    "brake-cal plot sedan-2up sample_logs/sedan/ramp_wet_asphalt.csv --out ramp.pdf",
    "brake-cal plot sedan-2up sample_logs/sedan/basalt_wet_pads.csv",
)
def plot(
    sources: list[str] = argument("Table, logs, results of validate.", "TABLE|RESULT|LOG..."),
    *,
    out: Path | None = option("File: .png, .svg, .pdf or .html.", "FILE", writes="drawing"),
    store: options.Tables,
    vehicle: options.OtherPads,
    figure: str | None = option("Draw only this panel; see above.", "NAME"),
    limits: options.StopLimits,
    channel_map: options.Map,
) -> Answer:
    """Draw tables, logs and results.

    A table is drawn with its curves and its map, and with the points of the ramps of its fit if
    they are given. A table and another log give the stop and its verdict. A log gives its channels.
    A PDF or HTML file holds all pages; of PNG and SVG there is one file per page. Without --out
    PNG files are written into this folder, named after their content.

    Panels for --figure of a table: f1-f2, map, map-band, tyre, posterior, pairs. Those of a stop or
    a result: axle-torques, pads, normalised-forces, slip; of a stop also map, which a result file
    does not hold. Those of a log: eta, and its channels: omega, p_mc and so on.
    """
    from calib.show.choose import sheet_facts, sheets
    from calib.show.stop import of_result

    table, logs, results = _read(sources, store, channel_map)
    if vehicle and not (table and logs):
        raise usage_error("only with a TABLE and a LOG", "--vehicle")
    drawn = [*sheets(table, logs, vehicle, limits), *map(of_result, results)]
    if figure is not None:
        for sheet in drawn:
            require_known(figure, sheet.names, "figure", "--figure")
    if out is not None and out.suffix.lower() in PAGES:
        files = [out]
        write_page(out, sheet_facts(drawn, figure))
    else:
        files = _draw(drawn, out, figure)
    keys = ("kind", "name", "title", "result", "note")
    documents = []
    for sheet in drawn:
        say(f"{sheet.title}: {', '.join(sheet.names)} (one alone with --figure NAME)")
        document = {key: getattr(sheet, key) for key in keys}
        documents.append(document | {"figures": sheet.names})
    return Answer({"files": files, "sheets": documents}, "\n".join(map(str, files)))


def _read(
    sources: list[str], store: options.Tables, channel_map: options.Map
) -> "tuple[Stored | None, list[Log], list[StoredResult]]":
    """Read the table, the logs and the results; any other source is the name of a table."""
    from calib.logs.formats import ending_of
    from calib.logs.read import FORMATS, REQUIRED
    from calib.show.result import is_result, read_result

    results, logs, names = list[Path](), list[Path](), list[str]()
    for source in sources:
        file = Path(source)
        if is_result(file):
            results.append(file)
        elif ending_of(file) in FORMATS:
            logs.append(file)
        else:
            names.append(source)
    if len(names) > 1:
        raise usage_error("expected one table; `tables diff` compares two", "TABLE")
    table = store.load(names[0]) if names else None
    if table:
        say(f"{table.id} is {table.state.description}")
    needed = REQUIRED if names else ()  # a log alone is drawn with the channels that it has
    read_logs = [read(path, channel_map, require=needed) for path in logs]
    return table, read_logs, [read_result(path) for path in results]


def _draw(drawn: "list[Sheet]", out: Path | None, figure: str | None) -> list[Path]:
    """Write all sheets into one PDF, or each into a file of its own, named after its content."""
    from calib.base.plain import counted
    from calib.show.sheet import save

    is_pdf = out is not None and out.suffix.lower() == ".pdf"
    files: dict[Path, list[Figure]] = {}
    for sheet in drawn:
        if out is None:
            file = Path(f"{sheet.name}-{figure}.png" if figure else f"{sheet.name}.png")
        elif len(drawn) == 1 or is_pdf:
            file = out
        else:
            file = out.with_name(f"{out.stem}-{sheet.name}{out.suffix}")
        while file in files and not is_pdf:  # logs of two folders may have the same name
            file = file.with_name(f"{file.stem}-2{file.suffix}")
        files.setdefault(file, []).append(sheet.figure(figure) if figure else sheet.overview())
    with writing(out), progress(f"drawing {counted(len(drawn), 'page')}", len(drawn)) as step:
        save(files, step)
    return list(files)
