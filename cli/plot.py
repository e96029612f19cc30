"""`brake-cal plot`: tables, results and logs as figures in a file."""

from pathlib import Path
from typing import TYPE_CHECKING

from cli import options
from cli.command import Answer, command
from cli.console import misuse, progress, say
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
    sources: list[str] = argument("A table, logs, results of validate.", "TABLE|RESULT|LOG..."),
    *,
    out: Path | None = option("A .png, .svg, .pdf or .html.", "FILE", writes="drawing"),
    store: options.Tables,
    vehicle: options.OtherPads,
    figure: str | None = option("One panel of the page, not all; see above.", "NAME"),
    limits: options.StopLimits,
    channel_map: options.Map,
) -> Answer:
    """Draw tables, logs and results.

    A table: its curves and its map, and with the ramps it was made of, their measured points. A
    table and another log: the stop and its verdict. A log: its channels. A PDF or HTML file holds
    all pages, of PNG and SVG there is one file per page; without --out they are PNG files in this
    directory, named after their content.

    Panels for --figure, of a table: f1-f2, map, map-band, tyre, posterior, pairs. Of a stop or a
    result: axle-torques, pads, normalised-forces, slip, and map of a stop. Of a log: eta, and its
    channels: omega, p_mc, ...
    """
    from calib.show.choose import sheet_facts, sheets
    from calib.show.stop import of_result

    table, logs, results = _read(sources, store, channel_map)
    if vehicle and not (table and logs):
        raise misuse("only with a TABLE and a LOG", "--vehicle")
    drawn = [*sheets(table, logs, vehicle, limits), *map(of_result, results)]
    if figure is not None:
        for sheet in drawn:
            require_known(figure, sheet.names, "figure ")
    if out is not None and out.suffix.lower() in PAGES:
        files = [out]
        write_page(out, sheet_facts(drawn, figure))
    else:
        files = _draw(drawn, out, figure)
    for sheet in drawn:
        say(f"{sheet.title}: {', '.join(sheet.names)} (one alone with --figure NAME)")
    keys = ("kind", "name", "title", "result", "note")
    documents = [{k: getattr(s, k) for k in keys} | {"figures": s.names} for s in drawn]
    return Answer({"files": files, "sheets": documents}, "\n".join(map(str, files)))


def _read(
    sources: list[str], store: options.Tables, channel_map: options.Map
) -> "tuple[Stored | None, list[Log], list[StoredResult]]":
    """Read all inputs; a name that is no log and no result is a table."""
    from calib.logs.formats import ending_of
    from calib.logs.read import FORMATS, REQUIRED
    from calib.show.result import is_result, read_result

    files = [Path(name) for name in sources]
    results = [p for p in files if is_result(p)]
    logs = [p for p in files if p not in results and ending_of(p) in FORMATS]
    names = [w for w, p in zip(sources, files, strict=True) if p not in results and p not in logs]
    if len(names) > 1:
        raise misuse("give one table; `tables compare` compares two", "TABLE")
    table = store.load(names[0]) if names else None
    if table:
        say(f"{table.id} is {table.state.description}")
    needed = REQUIRED if names else ()  # a log alone is drawn with the channels that it has
    read_logs = [read(path, channel_map, require=needed) for path in logs]
    return table, read_logs, [read_result(path) for path in results]


def _draw(drawn: "list[Sheet]", out: Path | None, figure: str | None) -> list[Path]:
    """Write one PDF with all, else one file for each, named after its content."""
    from calib.base.plain import counted
    from calib.show.sheet import save

    is_book = out is not None and out.suffix.lower() == ".pdf"
    files: dict[Path, list[Figure]] = {}
    for sheet in drawn:
        place = Path(f"{sheet.name}-{figure}.png" if figure else f"{sheet.name}.png")
        if out is not None:
            several = f"-{sheet.name}" if len(drawn) > 1 and not is_book else ""
            place = out.with_name(f"{out.stem}{several}{out.suffix}")
        while place in files and not is_book:  # logs from several directories have one name
            place = place.with_name(f"{place.stem}-2{place.suffix}")
        files.setdefault(place, []).append(sheet.figure(figure) if figure else sheet.overview())
    with writing(out), progress(f"drawing {counted(len(drawn), 'page')}", len(drawn)) as step:
        save(files, step)
    return list(files)
