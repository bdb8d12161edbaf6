"""Intervals of success rates."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError

NORMAL_95 = 1.959963984540054  # two-sided 95 % quantile of the normal distribution


def wilson_interval(num_successes: int, num_episodes: int) -> tuple[float, float]:
    """95 % interval of a success rate (E. B. Wilson 1927). (0, 1) without episodes."""
    if num_episodes == 0:
        return 0.0, 1.0
    n, rate, z2 = num_episodes, num_successes / num_episodes, NORMAL_95**2
    middle = (rate + z2 / (2 * n)) / (1 + z2 / n)
    half = NORMAL_95 / (1 + z2 / n) * sqrt(rate * (1 - rate) / n + z2 / (4 * n * n))
    return max(0.0, middle - half), min(1.0, middle + half)


@dataclass(frozen=True)
class Comparison:
    """Difference of two success rates over the same episodes."""

    name: str  #: Policy or controller.
    control: str  #: Control arm.
    difference: float  #: Success rate of `name` minus that of `control`.
    low: float  #: Lower end of the 95 % interval.
    high: float  #: Upper end of the 95 % interval.
    num_only: int  #: Episodes in which only `name` succeeds.
    num_control_only: int  #: Episodes in which only `control` succeeds.

    def __str__(self) -> str:
        return (
            f"{self.name} - {self.control}: {100 * self.difference:+.2f} % ({100 * self.low:+.2f} to {100 * self.high:+.2f}); "
            f"only {self.name} succeeds in {self.num_only} episodes, only {self.control} in {self.num_control_only}"
        )


def compare(name: str, successes: ArrayLike, control: str, control_successes: ArrayLike) -> Comparison:
    """Compares paired successes, (num_episodes) bool each, in the same order of episodes.

    The interval is method 10 of R. G. Newcombe, "Improved confidence intervals for the difference between binomial
    proportions based on paired data", Statistics in Medicine 17 (1998).
    """
    first, second = np.asarray(successes, bool), np.asarray(control_successes, bool)
    if first.shape != second.shape or first.ndim != 1 or not first.size:
        raise InputError(f"successes: shapes {first.shape} and {second.shape} are not allowed: equal ones, (num_episodes,)")
    n = first.size
    both, only, control_only = int((first & second).sum()), int((first & ~second).sum()), int((~first & second).sum())
    neither = n - both - only - control_only
    p1, p2 = (both + only) / n, (both + control_only) / n
    (low1, high1), (low2, high2) = wilson_interval(both + only, n), wilson_interval(both + control_only, n)
    covariance: float = both * neither - only * control_only
    if covariance > 0:
        covariance = max(covariance - n / 2, 0)
    product = (both + only) * (control_only + neither) * (both + control_only) * (only + neither)
    phi = covariance / sqrt(product) if product else 0.0

    def distance(a: float, b: float) -> float:
        return sqrt(max(0.0, a * a - 2 * phi * a * b + b * b))

    low = p1 - p2 - distance(p1 - low1, high2 - p2)
    high = p1 - p2 + distance(high1 - p1, p2 - low2)
    return Comparison(name, control, p1 - p2, low, high, only, control_only)
