"""A table as an FMU: the C code of an ECU in FMI 2.0 or 3.0, for co-simulation, with its sources.

    modelDescription.xml, sources/{bte.c, bte_car.c, fmi2.c or fmi3.c, headers} --zip--> car.fmu

No binary is inside: the tool that imports it compiles the sources, with its own headers of FMI.
"""

import hashlib
import io
import zipfile
from pathlib import Path
from typing import Literal, NamedTuple

from calib.base.names import AXLE_NAMES, AXLES, WHEELS
from calib.base.program import PROGRAM
from calib.base.write import write_whole
from calib.ecu.car_source import car_source
from calib.ecu.native import SOURCE, config
from calib.ecu.online import require_plain
from calib.ecu.width import Width
from calib.estimation.reasons import Reason
from calib.exports.dataset import prefix
from calib.exports.write import printable
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
    "s": {"s": 1},
}
"""Units of the variables, as powers of the base units of FMI."""


class Variable(NamedTuple):
    """A number of the FMU; ``unit`` None for an integer. Its reference is its place in the list."""

    name: str
    unit: str | None
    meaning: str
    causality: str = "output"

    @property
    def variability(self) -> str:
        """Inputs are those of a car that moves; answers change with a step."""
        return "discrete" if self.causality == "output" else "continuous"


_INPUTS = (
    ("p_mc", "Pa", "Pressure of the master cylinder"),
    ("a_x", "m/s2", "Acceleration at the center of gravity, forward positive"),
    *((f"omega_{wheel}", "rad/s", f"Speed of wheel {wheel}") for wheel in WHEELS),
    ("steering", "rad", "Angle at the driver's wheel; 0 where nobody measures it"),
    ("driven", "1", "1 while the accelerator is pressed; 0 where nobody knows"),
    *(
        (f"T_drive_{axle}", "N.m", f"Torque of engine or motor, {axle}; 0 unknown")
        for axle in AXLES
    ),
)
_OUTPUTS = (
    ("level", "1", "Brake torque over that of the vehicle file's pads"),
    ("ratio", "1", "Friction of the front pads over that of the rear ones"),
    *((f"pad_friction_{a}", "1", f"Friction of the {at} pads") for a, at in AXLE_NAMES.items()),
    *((f"brake_torque_{a}", "N.m", f"Torque of one {at} brake") for a, at in AXLE_NAMES.items()),
    ("brake_torque_sum", "N.m", "Torque of all brakes"),
)
_BOUNDS = {"": "", "_lower": ", lower end of 95 %", "_upper": ", upper end of 95 %"}

VARIABLES = (
    *(Variable(*x, causality="input") for x in _INPUTS),
    *(
        Variable(f"{name}{bound}", unit, f"{meaning}{end}")
        for name, unit, meaning in _OUTPUTS
        for bound, end in _BOUNDS.items()
    ),
    Variable("reason", None, "; ".join(f"{int(reason)} {reason.words}" for reason in Reason)),
)
"""In the order of the references, which is that of fmu.h."""


def write_fmu(
    table: Table,
    path: Path,
    sample_time: float,
    width: Width,
    version: Version,
    told: str,
    digest: str,
) -> bytes:
    """Write a table as an FMU to the file ``path``, and return what was written.

    Parameters
    ----------
    table : with maps.
    path : of the .fmu; an existing file is replaced.
    sample_time : of the task of the ECU [s], and the fixed step of the FMU.
    width : of the numbers inside; those of the variables are in double.
    version : of FMI, 2 for 2.0 or 3 for 3.0.
    told : what the FMU says of its table, in a sentence without its point.
    digest : of the table, the comment of the zip.

    The bytes depend on nothing but these. Raises
    StoreError as `require_plain`; ExchangeError for a precision that C does not have; OSError.
    """
    require_plain(table)
    name, step = prefix(table.vehicle.name), repr(float(sample_time))
    sources = _sources(table, sample_time, width, version, name)
    token = hashlib.sha256("".join(sources.values()).encode()).hexdigest()[:32]
    own = {"NAME": f'"{name}"', "TOKEN": f'"{token}"', "SAMPLE_TIME": step}
    sources["fmu_config.h"] = "".join(f"#define FMU_{key} {x}\n" for key, x in own.items())
    described = _described(
        version,
        name=printable(table.vehicle.name),
        identifier=name,
        token=token,
        step=step,
        description=f"{printable(told)}. Brake torque of each axle, estimated every {step} s; a "
        "communication step is a multiple of that, and the inputs are held in it.",
        compiled=[file for file in sources if file.endswith(".c")],
    )
    content = _zipped(described, sources, digest)
    write_whole(path, content)
    return content


def _sources(
    table: Table, sample_time: float, width: Width, version: Version, name: str
) -> dict[str, str]:
    """The code by file, but for fmu_config.h."""
    fixed = [SOURCE / "bte.c", SOURCE / "bte.h", GLUE / "fmu.h", GLUE / f"fmi{version}.c"]
    made = {
        "bte_config.h": config(width),
        "bte_car.c": car_source(table, sample_time, width, f"{name}, SHA-256 {table.digest}"),
    }
    return {path.name: path.read_text(encoding="utf-8") for path in fixed} | made


def _described(version: Version, **told: object) -> dict[str, str]:
    """The descriptions of the FMU and, in FMI 3.0, of how it is built, by file."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    made = Environment(
        loader=PackageLoader("calib.ecu"),
        undefined=StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        keep_trailing_newline=True,
    )
    files = {"modelDescription.xml": f"fmi{version}.xml.j2"}
    if version == 3:
        files["sources/buildDescription.xml"] = "build.xml.j2"
    told |= {"program": PROGRAM, "variables": VARIABLES, "units": UNITS}
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
