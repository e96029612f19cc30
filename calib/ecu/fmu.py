"""Write a table as an FMU for co-simulation (FMI 2.0 or 3.0): the estimator, or the car.

    p_mc --> car --a_x, wheel speeds--> estimator --> pad friction and torque with their bounds

The tool that imports an FMU compiles its sources with its own headers of FMI, unless the FMU has a
binary inside.
"""

import hashlib
import io
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Literal

from calib.base.errors import ProgramError
from calib.base.names import PROGRAM
from calib.base.templates import templates
from calib.base.write import write_whole
from calib.car.model import WET_ASPHALT, Model
from calib.ecu.car_data import CAR, sources
from calib.ecu.structures import source
from calib.estimation.known import known_effects
from calib.estimation.online import REASON, VARIABLES, Variable
from calib.estimation.reasons import Reason
from calib.exports.symbols import prefix
from calib.exports.write import printable
from calib.store.version import Stored
from calib.table.exported import Precision
from calib.table.table import Table

Version = Literal[2, 3]
Content = Literal["estimator", "car"]
_V0 = 30.0  # first speed of the car where nothing else is set [m/s]
_BOUNDS = {"": "", "_lower": ", lower end of 95 %", "_upper": ", upper end of 95 %"}
"""Ends of the names of an answer and its bounds, with the ends of their meanings."""
_CAR_REASONS = (  # values of ``reason`` in an FMU of the car
    "0 the car drives; 1 it stands; 2 an axle would lift; 3 a wheel would pass the peak of its tyre"
)


def _variables(content: Content) -> Iterator[Variable]:
    """Return the variables of the FMU, in the order of their references."""
    for causality in ("input", "parameter", "output", "independent"):
        ends = _BOUNDS if content == "estimator" and causality == "output" else {"": ""}
        # a kind is causality and variability, such as "parameter fixed"; "" if not in this FMU
        alike = [x for x in VARIABLES.values() if getattr(x, content).startswith(causality)]
        for x, (end, words) in product(alike, ends.items()):
            yield x._replace(name=x.name + end, meaning=x.meaning + words)
    reasons = "; ".join(f"{int(reason)} {reason.words}" for reason in Reason)
    yield REASON._replace(meaning=reasons if content == "estimator" else _CAR_REASONS)


def _starts(table: Table, content: Content) -> dict[str, float]:
    """Return the first values of parameters, and 0 for each input."""
    car = simulated(table)
    first = {"pad_friction_f": car.pad_friction_f, "pad_friction_r": car.pad_friction_r, "v0": _V0}
    first |= {f"tyre_{name}": x for name, x in vars(car.tyre).items()}
    kinds = {name: getattr(x, content) for name, x in VARIABLES.items()}
    set_by_host = [name for name, x in kinds.items() if x.startswith(("input", "parameter"))]
    return {name: first.get(name, 0.0) for name in set_by_host}


def simulated(table: Table) -> Model:
    """Return the car of a table as its ramp shows it; its tyres peak as on wet asphalt."""
    ramp, exponent = table.calibration, float(table.draws.load_exponent.mean())
    tyre = replace(WET_ASPHALT, stiffness=ramp.slip_stiffness.value, load_exponent=exponent)
    pads = ramp.pad_friction_f.value, ramp.pad_friction_r.value
    return Model(table.vehicle, *pads, tyre, known_effects(table))


def write_fmu(
    stored: Stored,
    path: Path,
    how: Precision,
    sample_time: float,
    version: Version,
    content: Content,
) -> None:
    """Write a version of a table as an FMU with a ``content``; an existing file is replaced.

    ``how`` is the precision of the numbers inside; variables are in double. ``sample_time`` of the
    ECU's task is the step of the FMU [s]. Equal arguments make equal bytes. Raises OSError, and as
    `sources` for a table that has no code.
    """
    car, step, first = stored.table.vehicle.name, repr(float(sample_time)), prefix(stored.name)
    name = f"{prefix(car)}_{content}"
    code = sources(stored, sample_time, how, first, f"{name}, SHA-256 {stored.digest}")
    glue = "fmi.c", f"fmi{version}.h", f"{content}.h"
    variables, starts = [*_variables(content)], _starts(stored.table, content)
    facts = {
        "version": version, "content": content, "name": name, "data": f"{CAR}_{first}",
        "step": step, "program": PROGRAM,
        "car": printable(car), "table": f"{stored.id}, {printable(stored.state.description)}",
        "compiled": [file for file in (*code, *glue) if file.endswith(".c")],
        "variables": variables, "references": ",\n       ".join(x.name.upper() for x in variables),
        "starts": starts, "given": len(starts), "first": ", ".join(map(repr, starts.values())),
    }  # fmt: skip
    unmarked = [source(file, token="", **facts) for file in glue]
    facts["token"] = hashlib.sha256(repr((facts, unmarked, code)).encode()).hexdigest()[:32]
    code |= {file: source(file, **facts) for file in glue}
    xml = templates("calib.ecu", markup=True).get_template
    inside = {"modelDescription.xml": xml("modelDescription.xml.j2").render(facts)}
    if version == 3:
        inside["sources/buildDescription.xml"] = xml("buildDescription.xml.j2").render(facts)
    inside |= {f"sources/{file}": text for file, text in code.items()}
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w") as out:
        for file, text in inside.items():  # without dates
            out.writestr(zipfile.ZipInfo(file), text, zipfile.ZIP_DEFLATED)
        out.comment = stored.digest.encode()
    write_whole(path, archive.getvalue())


def compile_fmu(path: Path) -> None:
    """Put a binary for this machine into an FMU. Raises ProgramError without FMPy or a compiler."""
    with zipfile.ZipFile(path) as archive:
        digest = archive.comment
    command = [sys.executable, "-m", "fmpy", "compile", str(path)]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    if ran.returncode:
        do = f"pip install fmpy, and have cmake and a compiler on PATH: {ran.stderr[-200:].strip()}"
        raise ProgramError("no binary could be made", where=path, do=do)
    with zipfile.ZipFile(path, "a") as archive:
        archive.comment = digest
