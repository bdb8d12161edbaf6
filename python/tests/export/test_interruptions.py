"""Full disks and kills: an error in one line, nothing that looks complete, and the same bytes when the export is run again."""

from __future__ import annotations

import resource
import subprocess
import sys

import pytest

import taxelsim
from taxelsim.export import FORMATS, export

from .conftest import files_of

pytest.importorskip("pyarrow")
pytest.importorskip("zarr")
pytest.importorskip("mcap_ros2")

LIMIT = 2048  # bytes of a file, which stands for a full disk; each format writes a longer one

KILL = """
import os, sys
from taxelsim.export import export, lerobot
lerobot.BLOCK_FRAMES = 39  # three episodes
export(sys.argv[1], sys.argv[2], "lerobot", on_progress=lambda done, total: os._exit(9) if done > 50 else None)
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
