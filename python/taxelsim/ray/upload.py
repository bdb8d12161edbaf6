"""Shards of a scratch folder, uploaded while others are made."""

from __future__ import annotations

import threading
from collections.abc import Iterable
from pathlib import Path

from .storage import MANIFEST, Storage, shard_name

_POLL = 0.25  # s


class Uploader(threading.Thread):
    """Uploads each of the shards as soon as its file is there. A file that is there is complete.

    A lost process loses the shards that it has not uploaded yet.
    """

    def __init__(self, storage: Storage, folder: Path, shards: Iterable[int], has_manifest: bool) -> None:
        super().__init__(daemon=True)
        self.stored: dict[int, tuple[str, int]] = {}  #: SHA-256 and bytes by shard.
        self._storage = storage
        self._folder = folder
        self._shards = list(shards)
        self._has_manifest = has_manifest
        self._end = threading.Event()
        self._error: Exception | None = None

    def run(self) -> None:
        try:
            is_last = False
            while not is_last:
                is_last = self._end.wait(_POLL)
                self._upload_found()
        except Exception as error:  # raised by check() in the thread that makes the shards
            self._error = error

    def check(self) -> None:
        """Raises what an upload raised."""
        if self._error is not None:
            raise self._error

    def end(self) -> None:
        """Waits until the shards in the folder are uploaded."""
        self._end.set()
        self.join()

    def _upload_found(self) -> None:
        for shard in [shard for shard in self._shards if (self._folder / shard_name(shard)).exists()]:
            if not self._has_manifest:
                self._storage.upload_text(MANIFEST, (self._folder / MANIFEST).read_bytes())
                self._has_manifest = True
            self.stored[shard] = self._upload(self._folder / shard_name(shard))
            self._shards.remove(shard)

    def _upload(self, file: Path) -> tuple[str, int]:
        """The shard first, then the checksum file that makes it count."""
        checksum = file.with_name(file.name + ".sha256")
        content = checksum.read_bytes()
        digest, size = content[:64].decode(), file.stat().st_size
        self._storage.upload(file, digest)
        self._storage.upload_text(checksum.name, content)
        return digest, size
