"""Intervals of success rates."""

from math import exp, lgamma, log

import pytest

import taxelsim
from taxelsim.policies import compare, wilson_interval


def paired(both: int, only: int, control_only: int, neither: int) -> tuple[list[bool], list[bool]]:
    counts = [(True, True, both), (True, False, only), (False, True, control_only), (False, False, neither)]
    return [a for a, _, n in counts for _ in range(n)], [b for _, b, n in counts for _ in range(n)]


def test_wilson_interval_of_known_counts():
    assert wilson_interval(15, 148) == pytest.approx((0.0624, 0.1605), abs=1e-4)  # Newcombe, Statistics in Medicine 17 (1998) 857
    assert wilson_interval(0, 20) == pytest.approx((0, 0.1611), abs=1e-4)
    assert wilson_interval(0, 0) == (0, 1)


def test_paired_interval_of_known_counts():
    first, second = paired(36, 12, 2, 0)
    comparison = compare("a", first, "b", second)
    assert comparison.difference == pytest.approx(0.2)
    assert (comparison.low, comparison.high) == pytest.approx((0.0569, 0.3404), abs=1e-4)
    assert (comparison.num_only, comparison.num_control_only) == (12, 2)
    assert str(comparison).startswith("a - b: +20.00 % (+5.69 to +34.04)")


def test_paired_interval_is_antisymmetric_and_contains_the_difference():
    for table in [(3, 1, 2, 4), (0, 0, 0, 5), (5, 0, 0, 0), (0, 4, 0, 0), (10, 3, 0, 7)]:
        first, second = paired(*table)
        forward, backward = compare("a", first, "b", second), compare("b", second, "a", first)
        assert forward.low <= forward.difference <= forward.high
        assert (forward.low, forward.high) == pytest.approx((-backward.high, -backward.low))


@pytest.mark.parametrize("rates", [(0.4, 0.3, 0.1), (0.8, 0.1, 0.05), (0.3, 0.2, 0.2)])
def test_paired_interval_covers_the_true_difference_in_95_percent(rates):
    p = [*rates, 1 - sum(rates)]
    n, covered = 14, 0.0
    for a in range(n + 1):
        for b in range(n + 1 - a):
            for c in range(n + 1 - a - b):
                table = [a, b, c, n - a - b - c]
                first, second = paired(*table)
                comparison = compare("a", first, "b", second)
                if comparison.low <= p[1] - p[2] <= comparison.high:
                    covered += exp(lgamma(n + 1) + sum(k * log(q) - lgamma(k + 1) for k, q in zip(table, p, strict=True)))
    assert 0.93 < covered < 0.995


def test_refuses_successes_of_different_episodes():
    with pytest.raises(taxelsim.InputError, match=r"\(2,\) and \(3,\) are not allowed"):
        compare("a", [True, False], "b", [True, False, True])
