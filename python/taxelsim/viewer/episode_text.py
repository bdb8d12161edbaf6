"""An episode in words."""

from __future__ import annotations

import numpy as np

from .source import Episode


def summary_of(episode: Episode, largest_force: float) -> str:
    """A Markdown table of the values in meta/."""
    rows = [f"| {_escaped(name.removeprefix('meta/'))} | {_escaped(value)} |" for name, value in episode.columns.items() if "meta/" in name]
    head = f"# Episode {episode.number}\n\n{len(episode)} frames. The brightest colour of a taxel is {largest_force:.3g} N.\n\n"
    return head + "\n".join(["| | |", "|---|---|", *rows])


def _escaped(value: object) -> str:
    """Text in a cell of a table: characters with a meaning in Markdown have a backslash."""
    text = f"{value:.6g}" if isinstance(value, float | np.floating) else str(value)
    return "".join("\\" + c if c in "\\`*_[]<>|#" else c for c in " ".join(text.split()))
