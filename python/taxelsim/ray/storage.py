"""Files in a directory that fsspec reaches: an object store, a remote file system."""

from __future__ import annotations

import hashlib
import re
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import fsspec

from ..errors import InputError, IoError

T = TypeVar("T")

ATTEMPTS = 5
FIRST_DELAY = 0.5  # s, doubled after each attempt: 7.5 s in all
_BLOCK_BYTES = 8 << 20

MANIFEST = "dataset.yaml"
VIEW = "dataset.h5"
CHECKSUMS = "dataset.checksums"
NAMES = re.compile(r"shard-\d{6,}\.h5(\.sha256)?|dataset\.(yaml|h5|h5\.sha256|checksums)")


def shard_name(shard: int) -> str:
    """Name of the file of a shard."""
    return f"shard-{shard:06}.h5"


def one_line(error: BaseException) -> str:
    """The message of an exception in one line, with its type if it has no message."""
    return " ".join(str(error).split()) or type(error).__name__


def is_remote(out: str) -> bool:
    """Whether `out` is an address of fsspec and not a path of this machine."""
    return "://" in out and not out.startswith(("file://", "local://"))


def checksum_line(digest: str, name: str) -> bytes:
    """Content of the checksum file of `name`, as sha256sum writes it."""
    return f"{digest}  {name}\n".encode()


def _digest(files: Any, path: str) -> tuple[str, int]:
    digest, size = hashlib.sha256(), 0
    with files.open(path, "rb", block_size=_BLOCK_BYTES, cache_type="readahead") as stream:
        while block := stream.read(_BLOCK_BYTES):
            digest.update(block)
            size += len(block)
    return digest.hexdigest(), size


class Storage:
    """Reads and writes the files of a data set, or others with certain names.

    Every method waits, and tries again with back-off if the storage fails. After a failure it opens the file system again, which reads
    credentials that were renewed. Raises IoError with one line after the last attempt.
    """

    def __init__(self, url: str, options: Mapping[str, Any], names: re.Pattern[str] = NAMES) -> None:
        self.url = url.rstrip("/")
        self._options = dict(options)
        self._names = names
        self._open: tuple[Any, str] | None = None
        protocol = self.url.partition("://")[0]
        try:
            fsspec.get_filesystem_class(protocol)
        except (ImportError, ValueError) as error:
            raise InputError(f"{url}: {one_line(error)}") from error

    def read(self, name: str) -> bytes | None:
        """Content of a file; None if it is missing."""
        return self._present(lambda files, path: files.cat_file(path), name)

    def digest(self, name: str) -> tuple[str, int] | None:
        """Hexadecimal SHA-256 and bytes of a file as the storage has it now; None if it is missing."""
        return self._present(_digest, name)

    def sizes(self) -> dict[str, int]:
        """Bytes of the files, by name; those with other names are left out. Empty if the directory is missing."""

        def listed(files: Any, path: str) -> dict[str, int]:
            entries = ((entry["name"].rpartition("/")[2], entry) for entry in files.ls(path, detail=True))
            return {name: entry["size"] for name, entry in entries if entry["type"] == "file" and self._names.fullmatch(name)}

        return self._present(listed, "") or {}

    def upload(self, file: Path, digest: str) -> None:
        """Stores a file under its own name, reads it back, and compares it with its SHA-256.

        The caller stores the checksum file afterwards: without one the file does not count.
        """
        name = file.name

        def put(files: Any, path: str) -> None:
            files.makedirs(path.rpartition("/")[0], exist_ok=True)
            files.put_file(str(file), path)
            files.invalidate_cache()
            found, _ = _digest(files, path)
            if found != digest:
                raise OSError(f"its SHA-256 is {found} after the upload, {digest} before")

        self._retried(lambda: self._once(put, name), name)

    def upload_text(self, name: str, content: bytes) -> None:
        """Stores a small file and reads it back."""

        def put(files: Any, path: str) -> None:
            files.makedirs(path.rpartition("/")[0], exist_ok=True)
            files.pipe_file(path, content)
            files.invalidate_cache()
            if files.cat_file(path) != content:
                raise OSError("it has other bytes after the upload")

        self._retried(lambda: self._once(put, name), name)

    def _present(self, action: Callable[[Any, str], T], name: str) -> T | None:
        def read() -> T | None:
            try:
                return self._once(action, name)
            except FileNotFoundError:
                return None

        return self._retried(read, name)

    def _once(self, action: Callable[[Any, str], T], name: str) -> T:
        if name and not self._names.fullmatch(name):
            raise InputError(f"{self.url}: {name!r} is no name of a file that belongs there")
        if self._open is None:
            self._open = fsspec.core.url_to_fs(self.url, skip_instance_cache=True, **self._options)
        files, root = self._open
        files.invalidate_cache()
        return action(files, f"{root}/{name}" if name else root)

    def _retried(self, action: Callable[[], T], name: str) -> T:
        for attempt in range(ATTEMPTS):
            try:
                return action()
            except InputError:
                raise
            except Exception as error:  # libraries of storages raise what they like
                self._open = None
                if attempt + 1 == ATTEMPTS:
                    raise IoError(f"{self.url}/{name}: {one_line(error)}") from error
                time.sleep(FIRST_DELAY * 2**attempt)
        raise AssertionError("no attempts")
