"""Small pictures as SVG text, for a page that needs no other file."""

from __future__ import annotations

import base64
from html import escape

import numpy as np
from numpy.typing import NDArray

from ..pictures import png_of
from .summary import Distribution

WIDTH, HEIGHT, MARGIN = 320, 130, 20  # pixels of a histogram; the margin is below, for its axis


def number(value: float) -> str:
    """A number for people."""
    return f"{value:.4g}"


def unit_suffix(unit: str) -> str:
    """The unit after a number; nothing for 1."""
    return "" if unit == "1" else f" {unit}"


def histogram(distribution: Distribution) -> str:
    """Bars, with the count and the range of each as a tooltip."""
    top = max(1, int(distribution.counts.max()))
    step = WIDTH / len(distribution.counts)
    bars = []
    for k, count in enumerate(distribution.counts.tolist()):
        height = (HEIGHT - MARGIN) * count / top
        low, high = number(distribution.edges[k]), number(distribution.edges[k + 1])
        place = f'x="{k * step:.2f}" y="{HEIGHT - MARGIN - height:.2f}" width="{step - 1:.2f}" height="{height:.2f}"'
        bars.append(f'<rect {place} data-count="{count}"><title>{low} to {high}: {count}</title></rect>')
    low, high = number(distribution.edges[0]), escape(number(distribution.edges[-1]) + unit_suffix(distribution.unit))
    axis = f'<text x="0" y="{HEIGHT - 5}">{low}</text><text x="{WIDTH}" y="{HEIGHT - 5}" text-anchor="end">{high}</text>'
    label = escape(f"Histogram of {distribution.name}")
    return f'<svg role="img" aria-label="{label}" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}">{"".join(bars)}{axis}</svg>'


def image_tag(picture: NDArray[np.uint8], text: str) -> str:
    """A picture (height, width, 3)."""
    data = base64.b64encode(png_of(picture)).decode()
    return f'<img src="data:image/png;base64,{data}" alt="{escape(text)}">'
