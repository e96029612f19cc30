"""Compare the numbers of qualifications made in different environments.

    python tests/studies/same_results.py A/qualification.json B/qualification.json ...

Prints the largest difference of each document from the first one, over the tolerance of the check.
Ends with 1 where it is past `MOST`, or where checks differ.
"""

import json
import sys
from pathlib import Path
from typing import Any

MOST = 1e-3
"""Largest difference between two environments, over the tolerance of the check [1]."""


def compare(first: dict[str, Any], other: dict[str, Any]) -> tuple[float, str]:
    """The largest difference [1], and the check in which it is."""
    pairs = zip(first["checks"], other["checks"], strict=True)
    departures = [(abs(a["value"] - b["value"]) / a["tolerance"], a["name"]) for a, b in pairs]
    return max(departures)


def main() -> int:
    """Compare the files of the command line."""
    first, *others = (json.loads(Path(name).read_text()) for name in sys.argv[1:])
    good = True
    for other in others:
        if first["verdict"] != "passed" or other["verdict"] != "passed":
            print("a check does not hold: nothing to compare")
            return 1
        largest, name = compare(first, other)
        versions = [f"NumPy {d['packages']['numpy']}, SciPy {d['packages']['scipy']}, "
                    f"{d['environment']['interpreter']}" for d in (first, other)]  # fmt: skip
        print(f"{versions[0]} against {versions[1]}: {largest:.1e} of a tolerance ({name})")
        good = good and largest <= MOST
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
