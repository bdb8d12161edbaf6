"""Full disks and kills: an error in one line, nothing that looks complete, and the same bytes when the export is run again."""

import resource
import subprocess
import sys

import pytest

import taxelsim
from taxelsim.export import FORMATS, export
from taxelsim.export.staging import write_json

from .conftest import files_of

pytest.importorskip("pyarrow")
pytest.importorskip("zarr")
pytest.importorskip("mcap_ros2")

LIMIT = 4096  # bytes of a file, which stands for a full disk: above the copy of the scene, below a file of each format

KILL = """
import os, sys
from taxelsim.export import export, lerobot
lerobot.BLOCK_FRAMES = 39  # three episodes
export(sys.argv[1], sys.argv[2], "lerobot", on_progress=lambda done, total: os._exit(9) if done > 50 else None)
"""

KILL_AT_END = """
import os, sys
from pathlib import Path
from taxelsim.export import export
folder, out, moment = sys.argv[1:]
rename, unlink = Path.rename, Path.unlink

def renamed(path, target):
    is_last = path.name == "out.incomplete"
    if is_last and moment == "before the rename":
        os._exit(9)
    rename(path, target)
    if is_last and moment == "after the rename":
        os._exit(9)

def unlinked(path, **options):
    unlink(path, **options)
    if path.name == "export.json":
        os._exit(9)

Path.rename, Path.unlink = renamed, unlinked
export(folder, out, "mcap")
"""


def content_of(out):
    return files_of(out) if out.is_dir() else out.read_bytes()


@pytest.mark.parametrize("name", FORMATS)
def test_a_full_disk(folder, exported, tmp_path, name):
    whole = content_of(exported(name, "whole"))
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (LIMIT, limits[1]))
    try:
        with pytest.raises(taxelsim.IoError, match=r"^\S*out\.incomplete: .*File too large$"):
            export(folder, tmp_path / "out", name)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert not (tmp_path / "out").exists()
    export(folder, tmp_path / "out", name)
    assert content_of(tmp_path / "out") == whole


def test_a_kill_in_the_middle_of_a_file(folder, tmp_path, monkeypatch):
    killed = subprocess.run([sys.executable, "-c", KILL, folder, tmp_path / "out"], capture_output=True)
    assert killed.returncode == 9, killed.stderr
    assert not (tmp_path / "out").exists()
    assert list((tmp_path / "out.incomplete").rglob(".*.tmp"))
    monkeypatch.setattr("taxelsim.export.lerobot.BLOCK_FRAMES", 39)
    for name in ("out", "whole"):
        export(folder, tmp_path / name, "lerobot")
    assert files_of(tmp_path / "out") == files_of(tmp_path / "whole")


@pytest.mark.parametrize("name", ["robomimic", "zarr"])
def test_links_of_somebody_else_are_not_followed(folder, tmp_path, name):
    precious = tmp_path / "precious"
    precious.write_text("kept")
    link = tmp_path / "out.incomplete"
    if name == "zarr":
        link.mkdir()
        link = link / ".lock"
    link.symlink_to(precious)
    with pytest.raises(taxelsim.IoError, match="symbolic links"):
        export(folder, tmp_path / "out", name)
    assert precious.read_text() == "kept"


def test_temporary_files_are_new(tmp_path):
    precious = tmp_path / "precious"
    precious.write_text("kept")
    (tmp_path / ".out.tmp").symlink_to(precious)
    write_json(tmp_path / "out", 1)
    assert (precious.read_text(), (tmp_path / "out").read_text()) == ("kept", "1\n")


@pytest.mark.parametrize("moment", ["before the rename", "after the rename", "after its plan is removed"])
def test_a_kill_at_the_end(folder, tmp_path, moment):
    killed = subprocess.run([sys.executable, "-c", KILL_AT_END, folder, tmp_path / "out", moment], capture_output=True)
    assert killed.returncode == 9, killed.stderr
    if moment != "after its plan is removed":
        export(folder, tmp_path / "out", "mcap")
    export(folder, tmp_path / "whole", "mcap")
    files = files_of(tmp_path / "out")
    files.pop(".lock", None)
    assert files == files_of(tmp_path / "whole")
