"""How every subcommand ends: one line on stderr and an exit status."""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable

from .._log import stderr_handler
from .._start import end_on_interrupt, raise_interrupts
from ..errors import Error, InputError


def run_command(name: str, run: Callable[[], int | None]) -> int:
    """Runs the subcommand `name` and returns its exit status: what `run` returns, None for 0.

    2 for bad input and for a package that is not installed, 1 for other errors, 130 after Ctrl-C.
    """
    logging.basicConfig(handlers=[stderr_handler()])
    try:
        raise_interrupts()
        return run() or 0
    except KeyboardInterrupt:
        return 130
    except (Error, ImportError, OSError) as error:
        print(f"taxelsim {name}: {error}", file=sys.stderr)
        return 2 if isinstance(error, InputError | ImportError) else 1
    finally:
        end_on_interrupt()
