"""Outputs that appear when they are complete: written as OUT.incomplete, renamed to OUT at the end."""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..errors import Error, InputError, IoError

PLAN = "export.json"  # in an incomplete folder: what is exported, so that only the same export continues it
_LOCK = ".lock"


def sync(path: Path) -> None:
    """Flushes a file or folder to the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _staged(out: Path) -> Path:
    if out.exists() and not (out.is_dir() and not any(out.iterdir())):
        raise InputError(f"{out}: exists; choose another output or remove it")
    if not out.parent.is_dir():
        raise InputError(f"{out}: its folder {out.parent} does not exist")
    return out.with_name(out.name + ".incomplete")


@contextmanager
def _named(staged: Path) -> Iterator[None]:
    """Gives errors of the file system the name of the output, in one line."""
    try:
        yield
    except Error:
        raise
    except OSError as error:
        raise IoError(f"{staged}: {' '.join((error.strerror or str(error)).split())}") from error


@contextmanager
def _locked(file: Path, out: Path) -> Iterator[None]:
    descriptor = os.open(file, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o644)
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise InputError(f"{out}: another program exports to it") from error
        yield
    finally:
        os.close(descriptor)


@contextmanager
def new_file(file: Path) -> Iterator[Path]:
    """A new, empty file in the same folder. It is flushed and renamed to `file` at the end, and removed on an exception."""
    file.parent.mkdir(parents=True, exist_ok=True)
    temporary = file.with_name(f".{file.name}.tmp")
    temporary.unlink(missing_ok=True)  # of a program that was killed, or a link that somebody else put there
    os.close(os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o666))
    try:
        yield temporary
        sync(temporary)
        temporary.rename(file)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    sync(file.parent)


def write_json(file: Path, content: Any) -> None:
    """Writes a file that appears when it is complete."""
    with new_file(file) as temporary:
        temporary.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def _check_plan(folder: Path, plan: dict[str, Any]) -> None:
    """Writes the plan into a new folder, or compares it with that of an interrupted export."""
    file = folder / PLAN
    plan = json.loads(json.dumps(plan))  # as it reads it: tuples are lists
    if not file.exists():
        others = [entry.name for entry in folder.iterdir() if entry.name not in (_LOCK, f".{PLAN}.tmp")]
        if others:
            raise InputError(f"{folder}: holds {min(others)}, and no {PLAN} of an interrupted export; remove it")
        write_json(file, plan)
        return
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
    except (ValueError, OSError) as error:
        raise InputError(f"{file}: {error}; remove {folder}") from error
    different = [key for key in plan if not isinstance(found, dict) or found.get(key) != plan[key]]
    if different:
        raise InputError(f"{folder}: an interrupted export with another {', '.join(different)}; remove it or choose another output")


@contextmanager
def staged_folder(out: Path, plan: dict[str, Any]) -> Iterator[Path]:
    """The folder OUT.incomplete, which an interrupted export with the same plan may have left. Becomes `out` at the end.

    Throws InputError if `out` exists and is not an empty folder, if another program writes it, or if the folder holds something else.
    """
    _take_back(out)
    staged = _staged(out)
    if staged.is_file():
        raise InputError(f"{staged}: is a file; remove it or choose another output")
    with _named(staged):
        staged.mkdir(exist_ok=True)
    with _named(staged), _locked(staged / _LOCK, out):
        _check_plan(staged, plan)
        yield staged
        sync(staged)
        staged.rename(out)
        (out / PLAN).unlink()  # last: where it is, the same export can be run again
        (out / _LOCK).unlink()
        sync(out)
        sync(out.parent)


def _take_back(out: Path) -> None:
    """Gives an export that was killed after its rename, and before its plan was removed, the name of an incomplete one."""
    staged = out.with_name(out.name + ".incomplete")
    if (out / PLAN).is_file() and not staged.exists():
        with _named(out), _locked(out / _LOCK, out):
            out.rename(staged)


@contextmanager
def staged_file(out: Path) -> Iterator[Path]:
    """The file OUT.incomplete, which replaces that of an interrupted export. Becomes `out` at the end.

    Throws InputError as staged_folder().
    """
    if out.is_dir():
        raise InputError(f"{out}: is a folder; this format is one file")
    staged = _staged(out)
    if staged.is_dir():
        raise InputError(f"{staged}: is a folder; remove it or choose another output")
    with _named(staged), _locked(staged, out):
        yield staged
        sync(staged)
        staged.rename(out)
        sync(out.parent)
