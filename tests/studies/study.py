"""What the studies share: their command line, the pool, shares."""

import argparse
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from typing import Any, TypeAlias, TypeVar

import pandas as pd
from scipy.stats import binomtest

Job = TypeVar("Job")
Result = TypeVar("Result")
Row: TypeAlias = Mapping[str, Any]


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
    options = parser.parse_args()
    for name, value in defaults.items():
        setattr(options, name, getattr(options, name) or value)
    print(" ".join(["#", *sys.argv[1:]]))
    return options


def carried_out(tried: Callable[[Job], Result], jobs: list[Job], workers: int) -> Iterator[Result]:
    """The results in the order of the jobs; ``tried`` is a function of a module."""
    if workers == 1:
        yield from map(tried, jobs)
        return
    with ProcessPoolExecutor(workers) as pool:
        yield from pool.map(tried, jobs)


def tabulated(
    tried: Callable[[Job], Iterable[Row]], jobs: list[Job], options: argparse.Namespace
) -> pd.DataFrame:
    """The rows of all jobs, kept as CSV where ``options`` name a file."""
    rows = pd.DataFrame(row for part in carried_out(tried, jobs, options.jobs) for row in part)
    if options.keep:
        rows.to_csv(options.keep, index=False)
    return rows


def share(hits: list[bool]) -> str:
    """A share with 95 % limits by Wilson's score interval."""
    if not hits:
        return "none"
    low, high = binomtest(sum(hits), len(hits)).proportion_ci(method="wilson")
    return f"{100 * sum(hits) / len(hits):.1f} % ({100 * low:.1f}-{100 * high:.1f}, n {len(hits)})"
