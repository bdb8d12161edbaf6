"""How the process of the command line starts: Ctrl-C ends it without a traceback, and it imports nothing from the current folder.

The package imports this module first. It changes nothing in other processes.
"""

from __future__ import annotations

import os
import sys


def _is_command_line() -> bool:
    """Whether `taxelsim` or `python3 -m taxelsim` started the process."""
    if sys.argv[:1] == ["-m"]:  # while Python looks for the module
        return sys.orig_argv[-len(sys.argv) :][:1] in (["taxelsim"], ["-mtaxelsim"])
    return "".join(sys.argv[:1]).rpartition("/")[2] == "taxelsim"


IS_COMMAND_LINE = _is_command_line()
if IS_COMMAND_LINE and sys.argv[0] == "-m" and not (sys.flags.isolated or getattr(sys.flags, "safe_path", False)):
    del sys.path[0]  # the current folder

import signal  # noqa: E402


def _end(number: int, _: object) -> None:
    os._exit(128 + number)


def raise_interrupts() -> None:
    """From here on Ctrl-C raises KeyboardInterrupt, as in any other program."""
    if signal.getsignal(signal.SIGINT) is _end:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def end_on_interrupt() -> None:
    """From here on Ctrl-C ends the process of the command line at once, unless a shell made it ignore Ctrl-C."""
    if IS_COMMAND_LINE and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)


end_on_interrupt()
if IS_COMMAND_LINE:
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])  # the program has it blocked while Python starts
