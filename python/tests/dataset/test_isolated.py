"""Data sets from strangers: HDF5 reads them in child processes."""

import os
import pickle
import shutil

import numpy as np
import pytest

import taxelsim

from .conftest import FORMAT_1

pytest.importorskip("h5py")


def test_every_column_is_as_without_isolation(folder):
    plain, isolated = taxelsim.Dataset(folder), taxelsim.Dataset(folder, isolated=True)
    assert set(isolated) == set(plain)
    assert isolated._identity() == plain._identity()
    rows = [3, 4, 5, 1, 9, 0]
    for name in plain:
        expected, found = plain[name], isolated[name]
        assert (found.shape, found.dtype, found.unit) == (expected.shape, expected.dtype, expected.unit)
        assert (found.value_names, found.bit_names) == (expected.value_names, expected.bit_names)
        np.testing.assert_array_equal(found[:], expected[:], err_msg=name)
        np.testing.assert_array_equal(found[rows], expected[rows], err_msg=name)
    assert isolated["data/time"][[]].shape == (0,)
    reopened = pickle.loads(pickle.dumps(isolated))
    np.testing.assert_array_equal(reopened.frames(7)["data/tactile_image"], plain.frames(7)["data/tactile_image"])


def test_format_1_is_read(tmp_path):
    data = taxelsim.Dataset(FORMAT_1, isolated=True)
    assert (data.num_episodes, data.num_frames) == (3, 6)
    np.testing.assert_array_equal(data["data/tactile_image"][:], taxelsim.Dataset(FORMAT_1)["data/tactile_image"][:])


def test_flipped_bits_do_not_end_this_process(tmp_path):
    copied = shutil.copytree(FORMAT_1, tmp_path / "copied")
    shard = copied / "shard-000001.h5"
    content = shard.read_bytes()
    problems = []
    for place in range(0, len(content), 499):
        changed = bytearray(content)
        changed[place] ^= 1 << place % 8
        shard.write_bytes(changed)
        try:
            taxelsim.Dataset(copied, isolated=True)["data/time"][:]
        except taxelsim.InputError as error:
            problems.append(str(error))
    assert problems
    assert all("shard-000001.h5" in problem for problem in problems)


def test_a_fifo_does_not_block(copied):
    (copied / "dataset.h5.sha256").unlink()
    os.mkfifo(copied / "dataset.h5.sha256")
    with pytest.raises(taxelsim.InputError, match=r"dataset\.h5"):
        taxelsim.Dataset(copied)
    (copied / "dataset.yaml").unlink()
    os.mkfifo(copied / "dataset.yaml")
    for isolated in (False, True):
        with pytest.raises(taxelsim.InputError, match=r"dataset\.yaml: not a regular file"):
            taxelsim.Dataset(copied, isolated=isolated)
