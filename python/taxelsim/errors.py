"""Exceptions. The message is one complete line: what was found, where, and what is allowed."""

from __future__ import annotations

import re


class Error(Exception):
    """Base class of all errors of taxelsim."""

    @property
    def instance(self) -> int | None:
        """Index of the first instance or environment that the error is about; None if it is about no single one."""
        found = re.search(r"\b(?:instance|environment) (\d+)", str(self))
        return int(found.group(1)) if found else None


class InputError(Error, ValueError):
    """A file, argument or value that the caller can correct."""


class ArgumentError(InputError, TypeError):
    """Arguments that a function does not take: of another type, missing or unknown."""


class OutOfRangeError(InputError, IndexError):
    """An index outside of a sequence."""


class DeviceError(Error, RuntimeError):
    """No device, out of device memory, or device lost."""


class IoError(Error, OSError):
    """The file system refused."""
