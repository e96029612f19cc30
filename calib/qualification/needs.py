"""What the program needs on a machine: packages in a version that holds, and what extras give."""

import platform
import re
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, metadata, version

from calib.program import NAME
from calib.qualification.environment import EXTRAS, declared


@dataclass(frozen=True)
class Need:
    """A package: the ``lowest`` version that is declared, the one ``found``, "" for none.

    ``extra`` that it belongs to, "" for one that is always needed.
    """

    package: str
    lowest: str
    found: str
    extra: str = ""

    @property
    def met(self) -> bool:
        """Whether the package is there in a version that holds."""
        return bool(self.found) and number(self.found) >= number(self.lowest)

    def __str__(self) -> str:
        lowest = f" (needs {self.lowest} or later)" if self.lowest else ""
        return f"{self.package} {self.found or 'is missing'}{lowest}"


def needs() -> tuple[Need, ...]:
    """Python, and every package that the program declares for users.

    Empty but for Python where the program runs from a folder without being installed.
    """
    packages = declared(NAME, EXTRAS)
    return (_python(), *(Need(p.package, p.lowest, found(p.package), p.extra) for p in packages))


def _python() -> Need:
    try:
        lowest = metadata(NAME)["Requires-Python"]
    except PackageNotFoundError:
        lowest = ""
    return Need("python", lowest.removeprefix(">="), platform.python_version())


def found(package: str) -> str:
    """The version of a package that is installed; "" for none."""
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


def number(written: str) -> tuple[int, ...]:
    """The leading numbers of a version, for a comparison.

    >>> number("2.10.1rc1") > number("2.9")
    True
    """
    digits = re.match(r"\d+(?:\.\d+)*", written)
    return tuple(int(part) for part in digits[0].split(".")) if digits else ()
