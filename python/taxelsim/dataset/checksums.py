"""SHA-256 of files, verified once per process."""

from __future__ import annotations

import hashlib
import os
import threading
from pathlib import Path

from ..errors import InputError, IoError

Stamp = tuple[int, int, int, int]  # device, inode, size in bytes, time of the last change in ns

_BLOCK_BYTES = 1 << 20
_lock = threading.Lock()
_verified: dict[str, Stamp] = {}


def stamp_of(file: Path) -> Stamp:
    """Changes when the file does. Throws IoError."""
    try:
        status = file.stat()
    except OSError as error:
        raise IoError(f"{file}: {error.strerror}") from error
    return status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns


def sha256_of(file: Path) -> str:
    """Hexadecimal SHA-256 of the bytes of a file. Throws IoError."""
    digest = hashlib.sha256()
    try:
        with file.open("rb", buffering=0) as stream:
            while block := stream.read(_BLOCK_BYTES):
                digest.update(block)
    except OSError as error:
        raise IoError(f"{file}: {error.strerror}") from error
    return digest.hexdigest()


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


def verify(file: Path) -> None:
    """Compares a file with its checksum file `NAME.sha256`, unless that was done before. Throws InputError if they differ, IoError."""
    if is_verified(file):
        return
    checksum = file.with_name(file.name + ".sha256")
    stamp = stamp_of(file)
    try:
        if not checksum.is_file():  # a FIFO would block
            raise FileNotFoundError(checksum)
        with checksum.open("rb") as stream:
            line = stream.read(1024)
    except FileNotFoundError as error:
        raise InputError(f"{file}: its checksum file {checksum.name} is missing") from error
    except OSError as error:
        raise IoError(f"{checksum}: {error.strerror}") from error
    expected, _, name = line.decode("ascii", "replace").partition("  ")
    if name != file.name + "\n" or len(expected) != 64:
        raise InputError(f"{checksum}: is not a line of sha256sum for {file.name}")
    found = sha256_of(file)
    if found != expected:
        raise InputError(f"{file}: its SHA-256 is {found}, not {expected} as in {checksum.name}: the file was changed")
    remember({os.fspath(file): stamp})


def forget_lock() -> None:
    """In a forked process: another thread of the parent may have held the lock."""
    global _lock
    _lock = threading.Lock()


os.register_at_fork(after_in_child=forget_lock)
