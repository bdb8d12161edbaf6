"""How subcommands serve a page until Ctrl-C."""

from __future__ import annotations

import sys
import time
from typing import Protocol

_POLL = 0.2  # s; the kernel may give SIGINT to a thread of the driver, which does not wake the main thread


class Page(Protocol):
    """A page that is served from its construction on."""

    url: str

    def close(self) -> None:
        """Stops the server."""


def serve(page: Page) -> None:
    """Prints the address of a page, waits for Ctrl-C, and closes the page."""
    try:
        print(f"open {page.url} ; Ctrl-C ends", flush=True)
        while True:
            time.sleep(_POLL)
    finally:
        print("ends", file=sys.stderr)
        page.close()
