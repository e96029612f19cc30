"""A quantity that is not below zero where it is there, seen with an error.

there: half of a normal distribution of ``spread`` M, seen as x with ``sigma`` u
not:   zero, seen as x with the same u              h = hypot(u, M)
"""

import math

MOST = 300.0
"""Largest logarithm of a ratio: more is sure."""

FAR = -5.0
"""Standard deviations below zero from which the quantity is as good as none."""


def likelihood_ratio(x: float, sigma: float, spread: float) -> float:
    """How much likelier x is where the quantity is there than where it is not; at most e^300."""
    return math.exp(min(log_likelihood_ratio(x, sigma, spread), MOST))


def log_likelihood_ratio(x: float, sigma: float, spread: float) -> float:
    """The logarithm of 2 u/h exp(x^2/2 (1/u^2 - 1/h^2)) Phi(x M/(u h)).

    With the normal distribution Phi; -inf where x is so far below zero that Phi is zero.
    """
    h = math.hypot(sigma, spread)
    normal = 0.5 * math.erfc(-x * spread / (sigma * h * math.sqrt(2.0)))
    if normal == 0.0:
        return -math.inf
    apart = 1.0 / sigma**2 - 1.0 / h**2
    return math.log(2.0 * sigma / h * normal) + 0.5 * x**2 * apart


def mean_square(x: float, sigma: float, spread: float) -> float:
    """Mean of the square of the quantity, if it is there and was seen as x.

    With m = x M^2/h^2 and s = u M/h, those of the normal distribution that it has above zero, and
    t = m/s: s^2 + m^2 + m s phi(t)/Phi(t) (Johnson, Kotz and Balakrishnan, Continuous Univariate
    Distributions, vol. 1, section 10.1).
    """
    h = math.hypot(sigma, spread)
    s = sigma * spread / h
    t = max(x / sigma * spread / h, FAR)
    m = s * t
    ratio = math.exp(-0.5 * t**2) / math.sqrt(0.5 * math.pi) / math.erfc(-t / math.sqrt(2.0))
    return s**2 + m**2 + m * s * ratio
