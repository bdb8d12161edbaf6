"""Damaged and missing files, and wrong arguments: one line that names the file."""

import hashlib
import re
import shutil

import numpy as np
import pytest

import taxelsim

from ..envs.conftest import write_scene

pytest.importorskip("h5py")


def flip_byte(file, place):
    content = bytearray(file.read_bytes())
    content[place] ^= 1
    file.write_bytes(content)


def test_a_damaged_shard_is_refused_before_hdf5_opens_it(copied, monkeypatch):
    flip_byte(copied / "shard-000001.h5", -100)
    data = taxelsim.Dataset(copied)
    assert data["data/time"][:52].shape == (52,)  # the other shards are read
    opened = []
    monkeypatch.setattr("taxelsim.dataset.shards.open_file", opened.append)
    for _ in range(2):
        with pytest.raises(taxelsim.InputError, match=r"copied/shard-000001\.h5: its SHA-256 is .*: the file was changed"):
            data.frames(52)
    assert opened == []


def test_a_damaged_shard_is_made_again_on_request(tmp_path, device):
    scene = write_scene(tmp_path)
    taxelsim.generate(scene, tmp_path / "out", device=device)
    shard = tmp_path / "out" / "shard-000000.h5"
    whole = shard.read_bytes()
    flip_byte(shard, -1)
    with pytest.raises(taxelsim.InputError, match=r"shard-000000\.h5"):
        taxelsim.generate(scene, tmp_path / "out", device=device)
    taxelsim.generate(scene, tmp_path / "out", device=device, repair=True)
    assert shard.read_bytes() == whole


def test_shards_by_range_give_the_bytes_of_a_whole_run(tmp_path, device):
    scene = write_scene(tmp_path)
    taxelsim.generate(scene, tmp_path / "one", device=device)
    last = len(list((tmp_path / "one").glob("shard-*.h5"))) - 1
    with pytest.raises(taxelsim.InputError, match="shards: range"):
        taxelsim.generate(scene, tmp_path / "many", device=device, shards=range(1, 1))
    taxelsim.generate(scene, tmp_path / "many", device=device, shards=range(last, last + 1))
    if last > 0:
        with pytest.raises(taxelsim.InputError, match=r"shard-000000\.h5 is missing"):
            taxelsim.finish(tmp_path / "many")
    assert taxelsim.generate(scene, tmp_path / "many", device=device, shards=range(last + 1)).complete
    taxelsim.finish(tmp_path / "many")
    files = [{file.name: file.read_bytes() for file in (tmp_path / name).iterdir()} for name in ("one", "many")]
    assert files[0] == files[1]


def test_a_damaged_view_is_refused(copied):
    flip_byte(copied / "dataset.h5", 2000)
    with pytest.raises(taxelsim.InputError, match=r"dataset\.h5: its SHA-256 is"):
        taxelsim.Dataset(copied)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("shard-000002.h5", r"shard-000002\.h5: the shard is missing; run generate again"),
        ("dataset.h5", r"copied: the data set is not complete: it has no dataset\.h5"),
        ("dataset.h5.sha256", r"dataset\.h5: its checksum file dataset\.h5\.sha256 is missing"),
        ("shard-000000.h5.sha256", r"shard-000000\.h5: its checksum file shard-000000\.h5\.sha256 is missing"),
        ("dataset.yaml", r"copied: no data set: it has no dataset\.yaml"),
    ],
)
def test_a_missing_file_is_named(copied, name, message):
    (copied / name).unlink()
    with pytest.raises(taxelsim.InputError, match=message):
        taxelsim.Dataset(copied).frames(0)


def test_a_shard_that_vanishes_later_is_named(copied):
    data = taxelsim.Dataset(copied)
    (copied / "shard-000000.h5").unlink()
    with pytest.raises(taxelsim.InputError, match=r"shard-000000\.h5: the shard is missing"):
        data.episode(0)


def test_a_checksum_of_another_file_is_refused(copied):
    shutil.copy(copied / "shard-000001.h5.sha256", copied / "shard-000000.h5.sha256")
    with pytest.raises(taxelsim.InputError, match=r"shard-000000\.h5\.sha256: is not a line of sha256sum for shard-000000\.h5"):
        taxelsim.Dataset(copied).frames(0)


def test_a_shard_of_another_place_is_refused(copied):
    shutil.copy(copied / "shard-000001.h5", copied / "shard-000000.h5")
    digest = hashlib.sha256((copied / "shard-000000.h5").read_bytes()).hexdigest()
    (copied / "shard-000000.h5.sha256").write_text(f"{digest}  shard-000000.h5\n")
    with pytest.raises(taxelsim.InputError, match=r"shard-000000\.h5: broken or foreign shard: shard is 1, not 0 as in the manifest"):
        taxelsim.Dataset(copied).frames(0)


def test_a_newer_format_is_refused(copied):
    manifest = copied / "dataset.yaml"
    manifest.write_text(manifest.read_text().replace("format_version: 2", "format_version: 3", 1))
    with pytest.raises(taxelsim.InputError, match=r"dataset\.yaml:2: format_version is 3; this program reads 1 to 2"):
        taxelsim.Dataset(copied)


def test_a_shard_is_verified_once_and_again_when_it_changes(copied, compared):
    for _ in range(2):
        data = taxelsim.Dataset(copied)
        data["data/time"][:]
    assert compared == [True] * 3 + [False] * 3
    flip_byte(copied / "shard-000002.h5", -100)
    with pytest.raises(taxelsim.InputError, match="the file was changed"):
        taxelsim.Dataset(copied).frames(-1)


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("tactile_image", "did you mean 'data/tactile_image'?"),
        ("data/tactil_image", "did you mean 'data/tactile_image'?"),
        ("objet_name", "did you mean 'meta/object_name'?"),
        ("xyz", "the columns are data/"),
        (3, "the columns are data/"),
    ],
)
def test_unknown_columns_get_a_suggestion(raw, name, hint):
    data = taxelsim.Dataset(raw)
    for read in (lambda: data[name], lambda: data.frames(0, [name]), lambda: data.windows(2, columns=[name])):
        with pytest.raises(taxelsim.InputError, match=rf"raw: no column {name!r}; {re.escape(hint)}"):
            read()


def test_indices_out_of_range_are_index_errors(raw):
    data = taxelsim.Dataset(raw)
    windows = data.windows(13)
    for read, message in (
        (lambda: data["data/time"][130], "raw: data/time: 130 is not allowed: -130 to 129"),
        (lambda: data.frames([0, 7, -131]), "raw: frames: -131 is not allowed: -130 to 129"),
        (lambda: data.episode(10), "raw: episode: 10 is not allowed: -10 to 9"),
        (lambda: windows[10], "raw: windows: 10 is not allowed: -10 to 9"),
        (lambda: data.windows(14)[0], "raw: windows: 0 is not allowed: there are none"),
    ):
        with pytest.raises(taxelsim.OutOfRangeError, match=message) as caught:
            read()
        assert isinstance(caught.value, IndexError)
        assert isinstance(caught.value, taxelsim.InputError)


@pytest.mark.parametrize(
    ("indices", "message"),
    [
        (1.5, r"float64 of shape \(\) is not allowed: integers of shape \(R,\)"),
        ([1.0], r"float64 of shape \(1,\) is not allowed: integers of shape"),
        ("3", r"<U1 of shape \(\) is not allowed: integers of shape"),
        (np.zeros((2, 2), int), r"shape \(2, 2\) is not allowed"),
        (np.ones(7, bool), r"a mask of shape \(7,\) is not allowed: \(130,\)"),
        (True, "bool is not allowed: an integer"),
    ],
)
def test_wrong_indices_are_refused(raw, indices, message):
    data = taxelsim.Dataset(raw)
    for read in (data.frames, data["data/time"].__getitem__):
        with pytest.raises(taxelsim.InputError, match=message):
            read(indices)


def test_wrong_sizes_are_refused(raw):
    data = taxelsim.Dataset(raw)
    for make, name in (
        (lambda: data.windows(0), "length"),
        (lambda: data.windows(4, 0), "stride"),
        (lambda: taxelsim.Dataset(raw, cache_bytes=0), "cache_bytes"),
    ):
        with pytest.raises(taxelsim.InputError, match=f"{name}: 0 is not allowed: at least 1"):
            make()
