"""Files whose SHA-256 is verified once per process."""

from __future__ import annotations

import os
import threading
from pathlib import Path

from ..errors import IoError

Stamp = tuple[int, int, int, int]  # device, inode, size in bytes, time of the last change in ns

_lock = threading.Lock()
_verified: dict[str, Stamp] = {}


def stamp_of(file: Path) -> Stamp:
    """Changes when the file does. Throws IoError."""
    try:
        status = file.stat()
    except OSError as error:
        raise IoError(f"{file}: {error.strerror}") from error
    return status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns


def is_verified(file: Path) -> bool:
    """Whether this process, or the one that it was pickled or forked from, verified the file as it is now."""
    with _lock:
        return _verified.get(os.fspath(file)) == stamp_of(file)


def remember(stamps: dict[str, Stamp]) -> None:
    """Adds files that are verified."""
    with _lock:
        _verified.update(stamps)


def verified_files(folder: Path) -> dict[str, Stamp]:
    """Verified files of a folder."""
    with _lock:
        return {file: stamp for file, stamp in _verified.items() if Path(file).parent == folder}


def forget_lock() -> None:
    """In a forked process: another thread of the parent may have held the lock."""
    global _lock
    _lock = threading.Lock()


os.register_at_fork(after_in_child=forget_lock)
