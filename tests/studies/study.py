"""What the studies share: their command line, the pool, shares, an estimate against the plant."""

import argparse
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from scipy.stats import binomtest

from calib.estimation.estimator import Estimate
from calib.logs.log import Log

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


def pair(values: np.ndarray, form: str = ".2f") -> str:
    """Front and rear."""
    front, rear = values
    return f"{front:{form}} / {rear:{form}}"


@dataclass(frozen=True)
class AgainstTruth:
    """An estimate against the pads of the plant at the samples that it calls valid: whether the
    95 % interval holds the true pad friction, the relative error, and the half width of the
    interval over the estimate, (2, n) each, front and rear [1]."""

    held: np.ndarray
    error: np.ndarray
    half_width: np.ndarray

    @classmethod
    def of(cls, e: Estimate, log: Log) -> "AgainstTruth":
        """Of an estimate of a log that holds its truth."""
        truth = np.array([log.truth["true_mu_pad_f"], log.truth["true_mu_pad_r"]])[:, e.valid]
        mu, lower, upper = (
            np.array([getattr(axle, name) for axle in (e.best.pads_f, e.best.pads_r)])[:, e.valid]
            for name in ("value", "lower", "upper")
        )
        held = (truth >= lower) & (truth <= upper)
        return cls(held, mu / truth - 1.0, 0.5 * (upper - lower) / mu)
