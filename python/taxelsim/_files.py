"""Files that are written as a whole."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from .errors import IoError


def require_folder(file: Path) -> None:
    """Raises IoError, before a long computation, if the folder of a file that will be written is missing."""
    if not file.parent.is_dir():
        raise IoError(f"{file}: No such file or directory")


def write_whole(file: Path, content: bytes) -> None:
    """Writes a file under a temporary name next to it, then renames it: a file that exists is complete. Raises IoError."""
    temporary = None
    try:
        with tempfile.NamedTemporaryFile(dir=file.parent, prefix=f".{file.name}.tmp-", delete=False) as stream:
            temporary = Path(stream.name)
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        mask = os.umask(0)
        os.umask(mask)
        temporary.chmod(0o666 & ~mask)
        temporary.replace(file)
    except OSError as error:
        if temporary is not None:
            temporary.unlink(missing_ok=True)
        raise IoError(f"{file}: {error.strerror}") from error
