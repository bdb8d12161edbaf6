"""Progress of a run on stderr."""

from __future__ import annotations

import sys
import time

_LOG_INTERVAL = 5.0  # s, between lines if stderr is no terminal
_DRAW_INTERVAL = 0.2  # s


class ProgressLine:
    """Items done: a line of a terminal that is drawn again, or a line every few seconds in a log."""

    def __init__(self, items: str) -> None:
        self._items = items
        self._begin = time.monotonic()
        self._last = self._begin
        self._is_drawn = False

    def show(self, done: int, total: int) -> None:
        """Called as often as is convenient."""
        now = time.monotonic()
        is_terminal = sys.stderr.isatty()
        if now - self._last < (_DRAW_INTERVAL if is_terminal else _LOG_INTERVAL):
            return
        self._last = now
        rate = done / (now - self._begin)
        left = f"  {(total - done) / rate:.0f} s left" if rate > 0 else ""
        line = f"{100 * done // total:3} %  {done:,} of {total:,} {self._items}  {rate:,.0f} {self._items}/s{left}"
        print(f"\r{line} " if is_terminal else f"info: {line}", end="" if is_terminal else "\n", file=sys.stderr, flush=True)
        self._is_drawn = is_terminal

    def end(self) -> None:
        """Ends the line of a terminal."""
        if self._is_drawn:
            print(file=sys.stderr)
            self._is_drawn = False
