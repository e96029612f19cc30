"""A table as an FMU of FMI 2.0 or 3.0, for co-simulation, with its sources: estimator or car.

    modelDescription.xml, sources/{bte.c, bte_car.c, fmi2.c or fmi3.c, headers} --zip--> car.fmu

No binary is inside: the tool that imports it compiles the sources, with its own headers of FMI.
"""

import hashlib
import io
import zipfile
from pathlib import Path
from typing import Literal

from calib.base.program import PROGRAM
from calib.base.templates import templates
from calib.base.write import write_whole
from calib.ecu.car_source import SOURCE, sources
from calib.ecu.fmu_models import FmuModel
from calib.ecu.online import require_plain
from calib.exports.dataset import prefix
from calib.exports.write import printable
from calib.table.exported import Precision
from calib.table.table import Table

Version = Literal[2, 3]

GLUE = SOURCE.parent / "fmu_source"

UNITS = {
    "1": {},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "m/s2": {"m": 1, "s": -2},
    "rad/s": {"rad": 1, "s": -1},
    "rad": {"rad": 1},
    "N.m": {"kg": 1, "m": 2, "s": -2},
    "m/s": {"m": 1, "s": -1},
    "s": {"s": 1},
}
"""Units of the variables, as powers of the base units of FMI."""


def write_fmu(
    table: Table,
    path: Path,
    sample_time: float,
    how: Precision,
    version: Version,
    of: FmuModel,
    told: str,
    digest: str,
) -> bytes:
    """Write a table as an FMU to the file ``path``, and return what was written.

    Parameters
    ----------
    table : with maps.
    path : of the .fmu; an existing file is replaced.
    sample_time : of the task of the ECU [s], and the fixed step of the FMU.
    how : the numbers inside are written; those of the variables are in double.
    version : of FMI, 2 for 2.0 or 3 for 3.0.
    of : the estimator, or the car of the table.
    told : what the FMU says of its table, in a sentence without its point.
    digest : of the table, the comment of the zip.

    The bytes depend on nothing but these. Raises
    StoreError as `require_plain`; ExchangeError for a precision that C does not have; OSError.
    """
    require_plain(table)
    name, step = f"{prefix(table.vehicle.name)}_{of.name}", repr(float(sample_time))
    files = sources(table, sample_time, how, f"{name}, SHA-256 {table.digest}")
    glue = {file: file for file in ("fmu.h", "fmi.h", f"fmi{version}.c")}
    for file, place in (glue | {"model.h": f"{of.name}.h"}).items():
        files[file] = (GLUE / place).read_text(encoding="utf-8")
    given = ", ".join(repr(x.start) for x in of.given)
    count = len(of.variables) - len(of.given) - 1
    numbers = f"static const double first_given[] = {{{given}}};\n"
    token = hashlib.sha256((numbers + "".join(files.values())).encode()).hexdigest()[:32]
    own = {"NAME": f'"{name}"', "TOKEN": f'"{token}"', "SAMPLE_TIME": step, "TOLD": count}
    files["fmu_config.h"] = "".join(f"#define FMU_{key} {x}\n" for key, x in own.items()) + numbers
    described = _described(
        version,
        name=f"{printable(table.vehicle.name)}, {of.name}",
        identifier=name,
        token=token,
        step=step,
        description=f"{printable(told)}. {of.what}, every {step} s; a communication step is a "
        "multiple of that, and the inputs are held in it.",
        compiled=[file for file in files if file.endswith(".c")],
        variables=of.variables,
    )
    content = _zipped(described, files, digest)
    write_whole(path, content)
    return content


def _described(version: Version, **told: object) -> dict[str, str]:
    """The descriptions of the FMU and, in FMI 3.0, of how it is built, by file."""
    made = templates("calib.ecu", markup=True)
    files = {"modelDescription.xml": f"fmi{version}.xml.j2"}
    if version == 3:
        files["sources/buildDescription.xml"] = "build.xml.j2"
    told |= {"program": PROGRAM, "units": UNITS}
    return {file: made.get_template(template).render(told) for file, template in files.items()}


def _zipped(described: dict[str, str], sources: dict[str, str], comment: str) -> bytes:
    """A zip without dates, so that the same table gives the same bytes."""
    files = described | {f"sources/{file}": text for file, text in sources.items()}
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as out:
        for file, text in files.items():
            out.writestr(zipfile.ZipInfo(file), text, zipfile.ZIP_DEFLATED)
        out.comment = comment.encode()
    return made.getvalue()
