"""`brake-cal qualify`: the program tried on this machine."""

from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any

import typer

from cli.console import emit, emit_json, json_text, progress, say
from cli.options import Json, example, out_folder
from cli.outputs import ready_folder, writing

EPILOG = example("brake-cal qualify --out qualification")
DOCUMENT, REPORT = "qualification.json", "qualification.html"
FAILED = 1


def qualify(
    out: Annotated[Path, out_folder(f"Write {DOCUMENT} and {REPORT} here.")],
    json: Json = False,
) -> None:
    """Try the program on this machine against known truths.

    Writes the environment and the checks with their results. Exit code 0 if all checks hold. Takes
    about 5 s of computing.
    """
    from calib.help.checks import SUITE
    from calib.help.qualify import facts, to_dict
    from calib.help.qualify import qualify as made
    from calib.show.html import page_of

    ready_folder(out, (DOCUMENT, REPORT))
    with progress(f"making {len(SUITE)} checks on the sample logs", len(SUITE)) as done:
        found = made(SUITE, done)
    document = to_dict(found, datetime.now(UTC).isoformat(timespec="seconds"))
    _write(out, document, page_of(facts(found, document)))
    if json:
        emit_json(document)
    else:
        emit(found.headline)
        emit(f"results, SHA-256: {document['digest']}")
    if found.failed:
        raise typer.Exit(FAILED)


def _write(out: Path, document: dict[str, Any], page: str) -> None:
    from calib.base.publish import publish, workshop
    from calib.base.write import write_whole

    with writing(out), workshop(out) as work:
        write_whole(work / REPORT, page.encode())
        write_whole(work / DOCUMENT, json_text(document).encode())
        publish(work, out, DOCUMENT)
    say(f"wrote {out}: {DOCUMENT}, {REPORT}")
