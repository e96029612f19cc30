"""What each cause looks like in a log: `calib/manual/gallery.md` and its pictures.

    python -m tests.support.gallery

Every effect of the catalogue is hidden in a car of the sample logs, or else of the independent
plant; a diagnosis names it, and the picture is that of its report. Run it after a change of a card
or of that figure, look at the pictures, and commit both.
"""

import json
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from io import BytesIO
from pathlib import Path

from PIL import Image

from calib.base.processes import cores
from calib.car.effects.catalogue import CATALOGUE
from calib.car.vehicle_file import read_vehicle
from calib.diagnosis.diagnose import diagnose
from calib.diagnosis.diagnosis import Diagnosis
from calib.logs.read import read_log
from calib.show.diagnosis_figure import diagnosis_sheet
from calib.show.numbers import spaced
from calib.show.sheet import render
from tests.support.hidden.cases import draw

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "calib" / "manual" / "gallery.md"
SAMPLES = ROOT / "sample_logs" / "hidden"
PICTURES = ROOT / "sample_logs" / "figures" / "causes"

_PANELS = {"a_x": "acceleration", "v": "speed", "rim": "speed"}
"""Panel of a report that shows a channel; any other one is a difference of wheel speeds."""
_SIZE, _COLOURS = (3.4, 2.3), 24
"""Size of a picture [in], and colours that a line with smooth edges needs."""
_SEED, _MEDIUM = 1, 1
_HEAD = """# What a cause looks like

You see a departure in your logs and wonder what makes it. Each picture shows a car with this one
cause, in the channel that shows it most: replay less measurement, once without the cause in the
model and once with it. Grey is the noise of the sensor. `brake-cal effects NAME` has the equation.

<!-- written by `python -m tests.support.gallery` -->

"""
_UNSEEN = """## What does not show

Pads and tyres take these up.

"""


def sample_of(name: str) -> Path | None:
    """The sample logs of a car that has one effect, if there are any."""
    answers = sorted(SAMPLES.glob("case_*/answer.json"))
    return next((p.parent for p in answers if json.loads(p.read_text())["effects"] == [name]), None)


def found_of(name: str) -> Diagnosis:
    """The diagnosis of a car that has one effect: of the sample, or of medium size."""
    if (case := sample_of(name)) is None:
        drawn = draw("single", _SEED, (name,), _MEDIUM)
        return diagnose(drawn.vehicle, list(drawn.calibration), list(drawn.holdout))
    logs = ([read_log(p) for p in sorted((case / k).iterdir())] for k in ("calibration", "holdout"))
    return diagnose(read_vehicle(case / "vehicle.toml"), *logs)


def picture(diagnosis: Diagnosis) -> Image.Image:
    """The panel of a report in which the effect that was named shows most, in few colours."""
    drawn = replace(diagnosis_sheet(diagnosis), title="", note="")
    figure = drawn.figure(_PANELS.get(diagnosis.effects[0].where.channel, "split"))
    figure.set_size_inches(*_SIZE)
    return Image.open(BytesIO(render(figure, ".png"))).convert("RGB").quantize(_COLOURS)


def sections(diagnoses: dict[str, Diagnosis]) -> Iterator[str]:
    """The page, part by part; what was not named is listed at its end."""
    yield _HEAD
    named = [n for n, one in diagnoses.items() if [e.name for e in one.effects] == [n]]
    for name in named:
        title, card = spaced(name).capitalize(), CATALOGUE[name].card
        looks = f"{card.looks_like[0].upper()}{card.looks_like[1:]}"
        yield f"## {title}\n\n{looks}.\n\n"
        yield f"![{title}](../../sample_logs/figures/causes/{name}.png)\n\n"
    yield _UNSEEN
    for name in sorted(diagnoses.keys() - set(named)):
        card = CATALOGUE[name].card
        yield f"* **{spaced(name).capitalize()}**, {card.cause}: {card.looks_like}.\n"


def main() -> None:
    """Make all of it anew."""
    with ProcessPoolExecutor(cores()) as pool:
        diagnoses = dict(zip(CATALOGUE, pool.map(found_of, CATALOGUE), strict=True))
    PICTURES.mkdir(exist_ok=True)
    for name, one in diagnoses.items():
        if [effect.name for effect in one.effects] == [name]:
            picture(one).save(PICTURES / f"{name}.png", optimize=True)
    PAGE.write_text("".join(sections(diagnoses)), encoding="utf-8")


if __name__ == "__main__":
    main()
