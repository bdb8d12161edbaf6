"""Tables of evaluations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np


def table_text(rows: Sequence[Sequence[str]]) -> str:
    """Cells in columns of equal width."""
    widths = [max(len(row[c]) for row in rows) for c in range(len(rows[0]))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows)


def quantiles_text(values: Any, per_si: float = 1) -> str:
    """Median and 95th percentile; "-" of an empty sample. per_si: display units in one SI unit."""
    return "-" if np.isnan(values.median) else f"{values.median * per_si:.3g} / {values.p95 * per_si:.3g}"


def rate_text(rate: float, low: float, high: float) -> str:
    """A rate and its interval, in percent."""
    return f"{100 * rate:.2f} % ({100 * low:.2f} to {100 * high:.2f})"


def plain(values: Any) -> list[Any]:
    """Numbers of an array for JSON: those that are not finite are None."""
    if values.ndim > 1:
        return [plain(row) for row in values]
    return [None if isinstance(v, float) and not np.isfinite(v) else v for v in values.tolist()]
