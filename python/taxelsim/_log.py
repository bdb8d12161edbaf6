"""The logger of the package, which has the messages of the library as well."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Iterator

from .errors import InputError

logger = logging.getLogger("taxelsim")

LEVELS = {
    "debug": logging.DEBUG,
    "info": logging.INFO,
    "warning": logging.WARNING,
    "error": logging.ERROR,
    "off": logging.CRITICAL + 1,
}
"""Names of levels, as of the program's option --log-level."""

_warned: set[str] = set()


def warn_once(message: str) -> None:
    """Logs a warning, each text once per process."""
    if message not in _warned:
        _warned.add(message)
        logger.warning("%s", message, stacklevel=2)


@contextlib.contextmanager
def silenced() -> Iterator[None]:
    """Drops messages, of all threads: those about the scene of a data set were logged when it was generated."""

    def drop(_: logging.LogRecord) -> bool:
        return False

    logger.addFilter(drop)
    try:
        yield
    finally:
        logger.removeFilter(drop)


def set_log_level(level: str) -> None:
    """Least level of messages: "debug", "info", "warning" (default), "error" or "off".

    Messages go to the logger "taxelsim" of Python's logging. Where the program has configured no handler, they are lines on stderr.
    """
    if level not in tuple(LEVELS):
        raise InputError(f"level: {level!r} is not allowed: {', '.join(LEVELS)}")
    logger.setLevel(LEVELS[level])
    if not logger.hasHandlers():
        logger.addHandler(stderr_handler())


class _Formatter(logging.Formatter):
    def format(self, record: logging.LogRecord) -> str:
        return f"{record.levelname.lower()}: {super().format(record)}"


def stderr_handler() -> logging.Handler:
    """Writes messages as the program does: "warning: ..."."""
    handler = logging.StreamHandler()
    handler.setFormatter(_Formatter())
    return handler
