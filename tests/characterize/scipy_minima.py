#!/usr/bin/env python3
"""Prints the table of minima in weighted_solve_test.cpp, by scipy.optimize.least_squares (SciPy 1.17; pip install scipy)."""

from __future__ import annotations

import numpy as np
from scipy.optimize import least_squares

GROUPS, ROWS = 5, 40
LOW, HIGH = np.array([0.01, -1] + [-np.inf] * GROUPS), np.array([10, 1] + [np.inf] * GROUPS)  # rate, offset, amplitudes
INDEX = np.arange(GROUPS * ROWS).reshape(GROUPS, ROWS)
TIME = 0.1 * np.arange(ROWS)
AMPLITUDE = 1.0 + np.arange(GROUPS)
Y = AMPLITUDE[:, None] * np.exp(-1.3 * TIME) + 0.2 + 0.02 * np.sin(7.0 * INDEX * INDEX)
WEIGHT = np.where(INDEX % 7 == 0, 0, 0.1 * (1 + INDEX % 10))


def minimum(held: dict[int, float], high: dict[int, float]) -> list[float]:
    """`held`: constant parameters; `high`: upper bounds."""
    free = [p for p in range(2 + GROUPS) if p not in held]
    parameters = np.array([1.0, 0.1] + [1.0] * GROUPS)
    upper = HIGH.copy()
    for p, value in held.items():
        parameters[p] = value
    for p, value in high.items():
        upper[p] = value

    def residuals(values: np.ndarray) -> np.ndarray:
        parameters[free] = values
        rate, offset = parameters[:2]
        return (WEIGHT * (parameters[2:, None] * np.exp(-rate * TIME) + offset - Y)).ravel()

    found = least_squares(residuals, parameters[free], "3-point", (LOW[free], upper[free]), "dogbox", 1e-15, 1e-15, 1e-15)
    parameters[free] = found.x
    return parameters.tolist()


own = {2 + g: AMPLITUDE[g] for g in range(GROUPS)}
CASES = {
    "Free": minimum({}, {}),
    "OffsetAtItsBound": minimum({}, {1: 0.15}),
    "ConstantOffsetAndAmplitude": minimum({1: 0.25, 4: 3}, {}),
    "NoOwnParameters": minimum(own, {}),
    "NoSharedParameters": minimum({0: 1.3, 1: 0.2}, {}),
}
for name, values in CASES.items():
    print(f'    {{"{name}", {{' + ", ".join(f"{value:.10f}" for value in values) + "}},")
