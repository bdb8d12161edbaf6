"""Hostile data sets and folders."""

import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import taxelsim
import taxelsim.envs
import taxelsim.mujoco
from taxelsim.program import PROGRAM

from ..envs.conftest import write_scene
from .tools import ROOT


@pytest.fixture(scope="module")
def two_episodes(tmp_path_factory, device):
    folder = tmp_path_factory.mktemp("two")
    taxelsim.generate(write_scene(folder), folder / "out", device=device, episodes=range(2))
    return folder / "out"


@pytest.fixture
def hostile(two_episodes, tmp_path):
    """A data set that a test may change."""
    return Path(shutil.copytree(two_episodes, tmp_path / "hostile"))


def links_to_another_file(file, other, num_rows):
    h5py = pytest.importorskip("h5py")
    del file["data/time"]
    file["data/time"] = h5py.ExternalLink(other, "/data/time")


def links_to_another_group(file, other, num_rows):
    h5py = pytest.importorskip("h5py")
    del file["data"]
    file["data"] = h5py.ExternalLink(other, "/data")


def links_within_the_file(file, other, num_rows):
    h5py = pytest.importorskip("h5py")
    file.move("data/time", "time")
    file["data/time"] = h5py.SoftLink("/time")


def stores_rows_elsewhere(file, other, num_rows):
    del file["data/time"]
    file.create_dataset("data/time", (num_rows,), "<f8", external=[(other, 0, 8 * num_rows)])


def shows_rows_of_another_file(file, other, num_rows):
    h5py = pytest.importorskip("h5py")
    del file["data/time"]
    layout = h5py.VirtualLayout((num_rows,), "<f8")
    layout[:] = h5py.VirtualSource(other, "data/time", (num_rows,))
    file.create_virtual_dataset("data/time", layout)


HOSTILE = {
    links_to_another_file: "data/time is a link",
    links_to_another_group: "is a link",
    links_within_the_file: "data/time is a link",
    stores_rows_elsewhere: "column data/time is not stored in this file",
    shows_rows_of_another_file: "column data/time is not stored in this file",
}


def change_shard(folder, change, other):
    """Changes the shard as an attacker does, who renews its checksum."""
    shard = folder / "shard-000000.h5"
    with pytest.importorskip("h5py").File(shard, "r+") as file:
        change(file, os.fspath(other), len(file["data/time"]))
    shard.with_name(f"{shard.name}.sha256").write_text(f"{hashlib.sha256(shard.read_bytes()).hexdigest()}  {shard.name}\n")


@pytest.mark.parametrize("change", HOSTILE)
@pytest.mark.parametrize("isolated", [False, True])
def test_a_data_set_reads_its_own_files_only(two_episodes, hostile, change, isolated):
    change_shard(hostile, change, two_episodes / "shard-000000.h5")
    data = taxelsim.Dataset(hostile, isolated=isolated)
    with pytest.raises(taxelsim.InputError, match=rf"shard-000000\.h5: .*{HOSTILE[change]}"):
        data.frames(0)


@pytest.mark.parametrize(
    "name", ["dataset.yaml", "dataset.h5", "dataset.h5.sha256", "shard-000000.h5", "shard-000000.h5.sha256", "elsewhere"]
)
def test_a_fifo_does_not_block(hostile, name):
    (hostile / name).unlink(missing_ok=True)
    os.mkfifo(hostile / name)
    if name == "elsewhere":
        change_shard(hostile, stores_rows_elsewhere, hostile / name)
    for isolated in (False, True):
        code = f"import taxelsim; taxelsim.Dataset({str(hostile)!r}, isolated={isolated}).frames(0)"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
        last = done.stderr.splitlines()[-1:]
        if not (isolated and name.startswith("dataset.h5")):  # the shards have the same numbers
            assert "".join(last).startswith("taxelsim.errors.InputError"), done.stderr


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("episodes_per_shard: ", "episodes_per_shard: 0  # "),
        ("compression: 0", "compression: 12"),
        ("name: data/time", "name: meta/episode_ends"),
        ("kp: 4", "kp: 5"),  # of the scene, whose SHA-256 is in the manifest
        ("format_version: 2", "format_version: 3"),
    ],
)
def test_data_sets_are_refused_for_the_same_manifests_as_by_inspect(hostile, old, new):
    manifest = hostile / "dataset.yaml"
    assert old in manifest.read_text()
    manifest.write_text(manifest.read_text().replace(old, new, 1))
    inspected = subprocess.run([PROGRAM, "inspect", hostile], capture_output=True, text=True)
    assert inspected.returncode == 2
    for isolated in (False, True):
        with pytest.raises(taxelsim.InputError) as caught:
            taxelsim.Dataset(hostile, isolated=isolated)
        assert inspected.stderr == f"taxelsim: {caught.value}\n"


def test_a_shard_that_hangs_its_reader_ends_within_ten_seconds(tmp_path):
    fuzz = ROOT / "tests/fuzz"
    shutil.copy(fuzz / "data/format_1.yaml", tmp_path / "dataset.yaml")
    shutil.copy(fuzz / "corpus/shard_1/bitflip_hang.h5", tmp_path / "shard-000000.h5")
    shutil.copy(fuzz / "corpus/shard_1/plain.h5", tmp_path / "shard-000001.h5")
    done = subprocess.run([PROGRAM, "inspect", tmp_path], capture_output=True, text=True, timeout=10)
    assert done.returncode == 2
    assert "shard-000000.h5: broken or hostile file: reading it took more than 5 s" in done.stderr


def test_a_folder_without_permission_is_not_an_empty_one(hostile):
    code = f"""
import os, pathlib, h5py, taxelsim
folder = pathlib.Path({str(hostile)!r})
folder.chmod(0)
if os.getuid() == 0:
    os.setuid(65534)  # permissions do not bind root
for isolated in (False, True):
    try:
        taxelsim.Dataset(folder, isolated=isolated)
    except taxelsim.IoError as error:
        print(error)
try:
    taxelsim.load_scene(folder / "scene.yaml")
except taxelsim.Error as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    hostile.chmod(0o755)
    assert [line.partition(": ")[2] for line in done.stdout.splitlines()] == 2 * ["Permission denied"] + [
        "cannot be read: Permission denied"
    ]
