"""A tyre property file (.tir): the braking part of Pacejka's Magic Formula 5.2 and later.

    d = F_z/F_N - 1,  F_N = LFZO FNOMIN                     load over the nominal load, less one
    K/F_z = (PKX1 + PKX2 d) exp(PKX3 d) LKX                 slip stiffness over load
    mu    = (PDX1 + PDX2 d) LMUX                            peak
    C     = PCX1 LCX                                        shape
    E     = (PEX1 + PEX2 d + PEX3 d^2) (1 + PEX4) LEX       curvature
    R_e   = R_0 - F_N/c_z (DREFF atan(BREFF F_z/F_N) + FREFF F_z/F_N)     rolling radius

Words in capitals are keys of the file; R_0 is UNLOADED_RADIUS, c_z is VERTICAL_STIFFNESS. Source:
Pacejka, Tyre and Vehicle Dynamics, 4.3.2 and (7.13). Offsets of the formula, camber and inflation
pressure are not read. Not valid far from the nominal load F_N.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from calib.base.arrays import Array
from calib.base.bounded import TYRE, bytes_of
from calib.base.digest import file_digest
from calib.base.errors import TyreError

# each key: least and largest value for tyres of cars and vans, and default (...: must be given)
_SCALE, _ANY = (0.1, 10.0, 1.0), (-math.inf, math.inf, 0.0)
_KEYS = {
    "FNOMIN": (500.0, 30000.0, ...), "LFZO": _SCALE,
    "PKX1": (4.0, 120.0, ...), "PKX2": (-60.0, 60.0, ...), "PKX3": (-2.0, 2.0, ...), "LKX": _SCALE,
    "PDX1": (0.2, 2.5, ...), "PDX2": (-1.0, 1.0, ...), "LMUX": _SCALE,
    "PEX1": (-20.0, 1.0, ...), "PEX2": _ANY, "PEX3": _ANY, "PEX4": _ANY, "LEX": (0.0, 10.0, 1.0),
    "PCX1": (1.0, 2.2, ...), "LCX": _SCALE,
    "UNLOADED_RADIUS": _ANY, "VERTICAL_STIFFNESS": _ANY,
    "DREFF": _ANY, "BREFF": _ANY, "FREFF": _ANY,
}  # fmt: skip

_UNITS = {"FORCE": ("newton", "newtons", "n"), "LENGTH": ("meter", "meters", "metre", "m")}
"""Keys of the units, and the values with which the file is in SI."""

_FAR = 3.0  # load over the nominal load, or the inverse, beyond which the polynomials fail
_KIND = "a tyre property file (.tir) of the Magic Formula 5.2, 6.1 or 6.2 (PAC2002, MF-Tyre)"
_LINE = re.compile(r"^[ \t]*(\w++)[ \t]*=[ \t]*'?([^\s$!']+)", re.MULTILINE)  # KEY = value


@dataclass(frozen=True)
class TyreFile:
    """The part of a tyre property file that concerns braking."""

    name: str  # of the file, without folder and ending
    source: str  # path of the file
    digest: str  # SHA-256 of its bytes
    keys: dict[str, float]  # [SI]

    def over_nominal(self, load: float) -> float:
        """Wheel ``load`` [N] over the nominal load [1]."""
        return load / (self.keys["FNOMIN"] * self.keys["LFZO"])

    def at_load(self, load: float) -> tuple[float, float]:
        """Slip stiffness over load [1], and peak [1], at a wheel ``load`` [N].

        Raises TyreError if the load or a result is not that of a usual tyre.
        """
        k, over_nominal = self.keys, self.over_nominal(load)
        d = over_nominal - 1.0
        stiffness = (k["PKX1"] + k["PKX2"] * d) * math.exp(k["PKX3"] * d) * k["LKX"]
        peak = (k["PDX1"] + k["PDX2"] * d) * k["LMUX"]
        is_usual_tyre = 2.0 < stiffness < 200.0 and 0.1 < peak < 3.0
        if not (is_usual_tyre and 1.0 / _FAR < over_nominal < _FAR):
            raise TyreError(
                f"at {load:.0f} N, the load of a wheel of this car, stiffness over load is "
                f"{stiffness:.3g} and the peak {peak:.3g}",
                where=self.source,
                expected=f"a load between a third of and three times {load / over_nominal:.0f} N, "
                "a stiffness of 2 to 200, and a peak of 0.1 to 3",
                do="give the file of a tyre of this car; check FNOMIN and the scale factors",
            )
        return stiffness, peak

    def curve(self, load: float) -> tuple[Array, Array]:
        """The tyre curve up to the peak at a wheel ``load`` [N]: F/mu and K slip/mu [1] (n,)."""
        k, d = self.keys, self.over_nominal(load) - 1.0
        C = k["PCX1"] * k["LCX"]
        E = (k["PEX1"] + k["PEX2"] * d + k["PEX3"] * d * d) * (1.0 + k["PEX4"]) * k["LEX"]
        x = np.linspace(0.0, 20.0, 4001)  # B slip, with B = K/(C mu)
        force = np.sin(C * np.arctan(x - min(E, 1.0) * (x - np.arctan(x))))  # E > 1 is no tyre
        count = int(np.argmax(force)) + 1  # of samples up to the peak
        return force[:count], C * x[:count]  # K slip/mu = C B slip

    def radius_load(self, load: float) -> float | None:
        """-(F_z/R_0) dR_e/dF_z [1], the fall of R_e with load; None without the keys of R_e."""
        k, over_nominal = self.keys, self.over_nominal(load)
        needed = ("UNLOADED_RADIUS", "VERTICAL_STIFFNESS", "BREFF", "DREFF")
        if not all(k[key] > 0.0 for key in needed):
            return None
        slope = k["DREFF"] * k["BREFF"] / (1.0 + (k["BREFF"] * over_nominal) ** 2) + k["FREFF"]
        return load / k["VERTICAL_STIFFNESS"] * slope / k["UNLOADED_RADIUS"]  # slope = -c_z dR_e/dF


def _read(path: Path | str) -> TyreFile:
    """Read a tyre property file. Raises one TyreError with all mistakes in the file."""
    from calib.base.record import OneOf, QuantityMark, section, validated  # pydantic is slow

    keys: dict[str, tuple[Any, Any]] = {}
    for key, (low, high, default) in _KEYS.items():
        keys[key] = (Annotated[float, QuantityMark("1", low, high)], default)
    for key, names in _UNITS.items():
        keys[key] = (Annotated[str, OneOf(names)], names[0])
    schema = section("TyreKeys", "The keys of a tyre property file that are read.", keys)
    text = bytes_of(Path(path), TYRE, TyreError, _KIND).decode("latin-1")
    entries = {key.upper(): value.lower() for key, value in _LINE.findall(text)}
    braking = {key: value for key, value in entries.items() if key in keys}
    values = validated(braking, schema, path, TyreError).model_dump(exclude={*_UNITS})
    return TyreFile(Path(path).stem, str(path), file_digest(Path(path)), values)


def read_tyres(paths: Sequence[Path]) -> tuple[TyreFile, ...]:
    """Read one file for both axles, or two for the front and the rear axle. Raises TyreError."""
    if len(paths) > 2:
        raise TyreError(f"{len(paths)} files of tyres", expected="one, or front and rear")
    return tuple(_read(path) for path in paths)
