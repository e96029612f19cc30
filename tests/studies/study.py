"""What the studies share: their command line, the pool, shares."""

import argparse
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from typing import TypeVar

from scipy.stats import binomtest

Job = TypeVar("Job")
Result = TypeVar("Result")


def arguments(doc: str | None, *flags: str, **defaults: object) -> argparse.Namespace:
    """The options of a study: ``flags`` are off, the others have a default of their type; a list
    is that of the names of which any number may be chosen, all of them unless told otherwise; a
    tuple is any number of words."""
    parser = argparse.ArgumentParser(
        description=doc, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    for name, value in defaults.items():
        option = f"--{name.replace('_', '-')}"
        if isinstance(value, list):
            parser.add_argument(option, action="append", choices=value, metavar="NAME")
        elif isinstance(value, tuple):
            parser.add_argument(option, nargs="*", default=value)
        else:
            parser.add_argument(option, type=type(value), default=value)
    for name in flags:
        parser.add_argument(f"--{name.replace('_', '-')}", action="store_true")
    asked = parser.parse_args()
    for name, value in defaults.items():
        setattr(asked, name, getattr(asked, name) or value)
    print(" ".join(["#", *sys.argv[1:]]))
    return asked


def carried_out(tried: Callable[[Job], Result], jobs: list[Job], workers: int) -> Iterator[Result]:
    """The results in the order of the jobs; ``tried`` is a function of a module."""
    if workers == 1:
        yield from map(tried, jobs)
        return
    with ProcessPoolExecutor(workers) as pool:
        yield from pool.map(tried, jobs)


def share(hits: list[bool]) -> str:
    """A share with 95 % limits by Wilson's score interval."""
    if not hits:
        return "none"
    low, high = binomtest(sum(hits), len(hits)).proportion_ci(method="wilson")
    return f"{100 * sum(hits) / len(hits):.1f} % ({100 * low:.1f}-{100 * high:.1f}, n {len(hits)})"
