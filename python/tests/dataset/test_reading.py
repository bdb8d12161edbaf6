"""Columns, episodes and frames of taxelsim.Dataset, compared with what h5py reads through dataset.h5."""

import os
import shutil
import subprocess
import sys
import time

import numpy as np
import pytest

import taxelsim

from ..test_documents import first_program
from .conftest import FORMAT_1

h5py = pytest.importorskip("h5py")

NUM_FRAMES = 130


def expected_of(folder, name):
    with h5py.File(folder / "dataset.h5") as file:
        values = file[name][:]
    return np.char.decode(values) if values.dtype.kind == "S" else values


def test_every_column_equals_that_of_h5py(folder):
    data = taxelsim.Dataset(folder)
    assert (data.num_episodes, data.num_frames) == (10, NUM_FRAMES)
    assert {"data/tactile_image", "data/action", "meta/success", "meta/episode_ends", "meta/object_name"} < set(data)
    for name in data:
        expected = expected_of(folder, name)
        assert data[name].shape == expected.shape
        values = data[name][:]
        assert values.dtype == expected.dtype
        np.testing.assert_array_equal(values, expected, err_msg=name)


def test_format_1_is_read(tmp_path):
    data = taxelsim.Dataset(FORMAT_1)
    for name in data:
        np.testing.assert_array_equal(data[name], expected_of(FORMAT_1, name), err_msg=name)
    assert data["data/tactile_image"].unit == "counts"
    shutil.copytree(FORMAT_1, tmp_path / "damaged")
    shard = tmp_path / "damaged/shard-000001.h5"
    content = shard.read_bytes()
    values = data["data/tactile_image"][4:].tobytes()
    shard.write_bytes(content.replace(values, values[::-1]))
    with pytest.raises(taxelsim.InputError, match=r"shard-000001\.h5: .*SHA-256 mismatch of data/tactile_image"):
        taxelsim.Dataset(tmp_path / "damaged").frames(5)


def test_indices_select_rows_and_values(folder):
    image = taxelsim.Dataset(folder)["data/tactile_image"]
    expected = expected_of(folder, "data/tactile_image")
    mask = np.arange(NUM_FRAMES) % 7 == 0
    for key in (
        5,
        -1,
        np.int32(60),
        slice(40, 70),
        slice(None, None, -9),
        [100, 3, 3, -2, 51],
        mask,
        (60, 2),
        ...,
        (..., 1),
        (slice(3, 60), 1, 2),
    ):
        np.testing.assert_array_equal(image[key], expected[key])
    np.testing.assert_array_equal(image[[3, 99], :, 4], expected[[3, 99], :, 4])
    assert image[[]].shape == (0, 6, 14)
    image[0][:] = 0  # a copy
    np.testing.assert_array_equal(image[0], expected[0])


def test_attributes_of_columns(raw):
    data = taxelsim.Dataset(raw)
    assert data["data/edge_angle"].unit == "rad"
    assert "sensor" in data["data/tactile_image"].description
    assert len(data["meta/load_driven"].value_names) == 2
    assert data["data/edge_angle"].value_names == ()
    assert data["meta/object_name"][:].tolist() == ["bar"] * 10
    assert data["meta/controller_name"][3] == "servo"
    assert data.attributes["format_version"] == 2
    assert data.attributes["seed"] == 5


def test_an_episode_has_its_frames_and_one_value_of_each_column_in_meta(folder):
    data = taxelsim.Dataset(folder)
    ends = data.episode_ends
    for index in (0, 5, -1):
        k = index % 10
        episode = data.episode(index)
        assert set(episode) == set(data)
        first = ends[k - 1] if k else 0
        np.testing.assert_array_equal(episode["data/action"], expected_of(folder, "data/action")[first : ends[k]])
        assert episode["meta/episode"] == k
        assert episode["meta/object_name"] == "bar"
        assert episode["data/time"][0] == 0


def test_frames_have_the_values_of_their_episodes(folder):
    data = taxelsim.Dataset(folder)
    frames = data.frames([129, 0, 12, 13, 60], ["meta/episode", "data/tactile_image", "meta/load"])
    assert list(frames) == ["meta/episode", "data/tactile_image", "meta/load"]
    assert frames["meta/episode"].tolist() == [9, 0, 0, 1, 4]
    np.testing.assert_array_equal(frames["meta/load"], expected_of(folder, "meta/load")[[9, 0, 0, 1, 4]])
    one = data.frames(60)
    assert set(one) == {name for name in data if name.startswith("data/")}
    np.testing.assert_array_equal(one["data/tactile_image"], frames["data/tactile_image"][4])


def test_the_program_of_the_document_runs(raw, tmp_path, monkeypatch):
    (tmp_path / "out").symlink_to(raw)
    monkeypatch.chdir(tmp_path)
    names = {"taxelsim": taxelsim}
    exec(first_program("docs/reference/python.md", "## Data sets"), names)
    assert names["frames"]["data/tactile_image"].shape == (3, 6, 14)
    assert names["frames"]["meta/object"].shape == (3,)
    assert len(names["windows"]) == 20


def test_random_frames_take_less_than_200_us(folder):
    data = taxelsim.Dataset(folder)
    data.frames(slice(None), ["data/tactile_image"])  # verifies and opens the shards
    durations = []
    for index in np.random.default_rng(1).integers(NUM_FRAMES, size=300).tolist():
        start = time.perf_counter()
        data.frames(index, ["data/tactile_image"])
        durations.append(time.perf_counter() - start)
    assert np.median(durations) < 200e-6


def test_the_cache_of_inflated_chunks_is_limited(generated):
    data = taxelsim.Dataset(generated["compressed"], cache_bytes=3000)
    np.testing.assert_array_equal(data["data/tactile_image"], expected_of(generated["compressed"], "data/tactile_image"))
    cache = data._shards._inflated
    assert 0 < cache._num_bytes <= 3000
    assert cache._num_bytes == sum(chunk.nbytes for chunk in cache._chunks.values())


def test_shards_beyond_the_limit_are_closed_and_opened_again(folder, monkeypatch):
    monkeypatch.setattr("taxelsim.dataset.shards.MAX_OPEN_SHARDS", 1)
    data = taxelsim.Dataset(folder)
    for index in (0, 129, 60, 0):
        np.testing.assert_array_equal(data["data/pose"][index], expected_of(folder, "data/pose")[index])
        assert len(data._shards._open) == 1


def test_importing_taxelsim_imports_neither_h5py_nor_torch():
    program = "import sys, taxelsim; taxelsim.Dataset; sys.exit(any(name in sys.modules for name in ('h5py', 'torch')))"
    subprocess.run([sys.executable, "-c", program], check=True, env=os.environ)


def test_a_missing_h5py_is_named(raw, monkeypatch):
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(ImportError, match=r"data sets need h5py: pip install 'taxelsim\[dataset\]'"):
        taxelsim.Dataset(raw)
