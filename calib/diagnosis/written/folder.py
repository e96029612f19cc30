"""The files of a diagnosis: document, model, report and replays, all of them or none.

DIR/diagnosis.json  model.toml  report.html  sim/before/<log>.csv  sim/after/<log>.csv
"""

from dataclasses import replace
from pathlib import Path

from calib.base.publish import publish, workshop
from calib.base.write import write_whole
from calib.diagnosis.diagnosis import Diagnosis
from calib.diagnosis.replays.gap import CHANNELS
from calib.logs.write import write_csv

DOCUMENT, MODEL, REPORT = "diagnosis.json", "model.toml", "report.html"


def files_of(stems: list[str]) -> list[Path]:
    """Every file that a diagnosis with these hold-outs writes, relative to its folder."""
    sims = [Path("sim", when, f"{s}.csv") for when in ("before", "after") for s in stems]
    return [Path(DOCUMENT), Path(MODEL), Path(REPORT), *sims]


def write_folder(found: Diagnosis, document: str, report: str, out: Path) -> list[Path]:
    """Write everything to ``out``, the document last, and return the paths.

    Replays of an earlier run that are not made again are removed. Other files in ``out`` stay.
    Raises OSError if ``out`` cannot be written.
    """
    from calib.car.model_file import write_model

    with workshop(out) as work:
        write_whole(work / DOCUMENT, document.encode())
        write_model(found.model_after, work / MODEL)
        write_whole(work / REPORT, report.encode())
        sims, paths = (*found.before, *found.after), files_of([sim.name for sim in found.before])
        for sim, path in zip(sims, paths[-len(sims) :], strict=True):
            (work / path).parent.mkdir(parents=True, exist_ok=True)
            told = {name: sim[name] for name in ("time", *CHANNELS)}
            write_csv(replace(sim, channels=told, truth={}), work / path)
        return publish(work, out, DOCUMENT, _replays)


def _replays(out: Path) -> list[str]:
    return [path.relative_to(out).as_posix() for path in out.glob("sim/*/*.csv")]
