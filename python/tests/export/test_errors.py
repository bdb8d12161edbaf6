"""Wrong arguments, damaged data sets and occupied outputs: one line, and no output."""

import fcntl
import sys

import numpy as np
import pytest

import taxelsim
from taxelsim.commands.export import main
from taxelsim.export import FORMATS, Options, export

from .conftest import NUM_FRAMES

pytest.importorskip("pyarrow")


def refused(folder, out, message, format_name="lerobot", **options):
    with pytest.raises(taxelsim.InputError, match=message):
        export(folder, out, format_name, Options(**options))
    assert not out.exists()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"format_name": "csv"}, "format: 'csv' is not allowed: lerobot, zarr, oxt, robomimic, mcap"),
        ({"episodes": (3, 10)}, r"episodes 3\.\.10 is not allowed: 0\.\.9"),
        ({"episodes": (4, 3)}, r"episodes 4\.\.3 is not allowed"),
        ({"columns": ("data/total_forc",)}, "no column 'data/total_forc'.*total_force"),
        ({"columns": ("meta/load",)}, "'meta/load' is not allowed: a column in data/"),
        ({"state": ("nothing",)}, "no column 'nothing'"),
        ({"columns": ("data/tactile_image",)}, "columns: data/tactile_image is not allowed: every export has it"),
        ({"tactile_key": "observation.tactile_image"}, "tactile_key: 'observation.tactile_image' is not allowed"),
        ({"tactile_key": "observation.state"}, "tactile_key: 'observation.state' is not allowed"),
        ({"zarr_format": 3}, "zarr_format: not an option of format lerobot"),
        ({"zarr_format": 4, "format_name": "zarr"}, "zarr_format: 4 is not allowed: 2 and 3"),
    ],
)
def test_wrong_options(folder, tmp_path, options, message):
    refused(folder, tmp_path / "out", message, **options)


def test_a_damaged_shard(copied, tmp_path):
    shard = copied / "shard-000001.h5"
    content = bytearray(shard.read_bytes())
    content[-100] ^= 1
    shard.write_bytes(content)
    refused(copied, tmp_path / "out", r"shard-000001\.h5: its SHA-256 is")


def test_no_data_set(tmp_path):
    refused(tmp_path, tmp_path / "out", "no data set")


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_numbers_that_are_not_finite(folder, tmp_path, monkeypatch, value):
    frames = taxelsim.Dataset.frames

    def damaged(self, indices, columns):
        values = frames(self, indices, columns)
        if indices.start == 0 and "data/action" in values:
            values["data/action"][7, 2] = value
        return values

    monkeypatch.setattr(taxelsim.Dataset, "frames", damaged)
    refused(folder, tmp_path / "out", f"data/action: {value} found in frame 7, a finite number needed")


@pytest.mark.parametrize("name", FORMATS)
def test_an_existing_file(folder, tmp_path, name):
    (tmp_path / "out").touch()
    with pytest.raises(taxelsim.InputError, match=r"out: exists; choose another output or remove it"):
        export(folder, tmp_path / "out", name)
    assert [entry.name for entry in tmp_path.iterdir()] == ["out"]


@pytest.mark.parametrize(("name", "kind"), [("lerobot", "file"), ("robomimic", "folder")])
def test_an_incomplete_output_of_another_kind(folder, tmp_path, name, kind):
    staged = tmp_path / "out.incomplete"
    staged.touch() if kind == "file" else staged.mkdir()
    with pytest.raises(taxelsim.InputError, match=rf"out\.incomplete: is a {kind}; remove it"):
        export(folder, tmp_path / "out", name)


def test_an_occupied_output(folder, tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out/notes.txt").touch()
    with pytest.raises(taxelsim.InputError, match=r"out: exists; choose another output or remove it"):
        export(folder, tmp_path / "out", "lerobot")
    assert [entry.name for entry in tmp_path.iterdir()] == ["out"]
    (tmp_path / "out/notes.txt").unlink()
    export(folder, tmp_path / "out", "lerobot")  # an empty folder is none


def test_a_folder_that_holds_something_else(folder, tmp_path):
    (tmp_path / "out.incomplete").mkdir()
    (tmp_path / "out.incomplete/notes.txt").touch()
    refused(folder, tmp_path / "out", r"out\.incomplete: holds notes\.txt, and no export\.json")


def test_another_interrupted_export(folder, tmp_path):
    def stop(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        export(folder, tmp_path / "out", "lerobot", on_progress=stop)
    refused(folder, tmp_path / "out", r"out\.incomplete: an interrupted export with another options; remove it", episodes=(0, 3))


@pytest.mark.parametrize("name", ["lerobot", "robomimic"])
def test_two_programs(folder, tmp_path, name):
    file = tmp_path / "out.incomplete"
    if name == "lerobot":
        file.mkdir()
        file /= ".lock"
    with file.open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        refused(folder, tmp_path / "out", "out: another program exports to it", name)


def test_a_folder_that_does_not_exist(folder, tmp_path):
    refused(folder, tmp_path / "none/out", "its folder .*none does not exist")


@pytest.mark.parametrize("name", FORMATS)
def test_a_missing_package(folder, tmp_path, monkeypatch, name):
    monkeypatch.setitem(sys.modules, FORMATS[name].packages[0], None)
    with pytest.raises(ImportError, match=rf"format {name} needs the package .*: pip install 'taxelsim\[export\]'"):
        export(folder, tmp_path / "out", name)


def test_command(folder, tmp_path, capfd):
    out = tmp_path / "out"
    arguments = [str(folder), "--format", "lerobot", "-o", str(out), "--episodes", "2..5"]
    assert main(arguments) == 0
    assert capfd.readouterr().out == f"{out}: 4 episodes, {4 * NUM_FRAMES} frames, format lerobot\n"
    assert main(arguments) == 2
    assert capfd.readouterr().err == f"taxelsim export: {out}: exists; choose another output or remove it\n"
    with pytest.raises(SystemExit):
        main([*arguments[:-1], "5"])
    assert "'5' is not allowed: a range such as 0..99" in capfd.readouterr().err
