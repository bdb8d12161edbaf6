"""Windows, and data sets in other processes and threads."""

import multiprocessing
import operator
import pickle
import sys
import types
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import taxelsim
from taxelsim.dataset import Windows, checksums

pytest.importorskip("h5py")


@pytest.mark.parametrize(("length", "stride"), [(1, 1), (5, 3), (13, 1), (12, 5), (14, 1)])
def test_windows_are_all_ranges_inside_an_episode(folder, length, stride):
    data = taxelsim.Dataset(folder)
    windows = data.windows(length, stride, ["data/tactile_image", "meta/episode"])
    images = data["data/tactile_image"][:]
    expected = [(k, 13 * k + first) for k in range(10) for first in range(0, 13 - length + 1, stride)]
    assert list(zip(windows.episodes.tolist(), windows.starts.tolist(), strict=True)) == expected
    assert len(windows) == len(expected)
    for window, (episode, first) in zip(windows, expected, strict=True):
        assert window["meta/episode"] == episode
        np.testing.assert_array_equal(window["data/tactile_image"], images[first : first + length])


def test_windows_have_all_columns_of_frames_by_default(raw):
    data = taxelsim.Dataset(raw)
    window = data.windows(4)[-1]
    assert set(window) == {name for name in data if name.startswith("data/")}
    assert all(isinstance(values, np.ndarray) and len(values) == 4 for values in window.values())


def test_windows_are_data_sets_of_torch_where_torch_is_imported(raw, monkeypatch):
    data = taxelsim.Dataset(raw)
    if "torch" not in sys.modules:
        assert type(data.windows(4)) is Windows
        assert "torch" not in sys.modules
    base = type("Dataset", (), {})
    monkeypatch.setitem(sys.modules, "torch.utils.data", types.SimpleNamespace(Dataset=base))
    windows = data.windows(4)
    assert isinstance(windows, base)
    again = pickle.loads(pickle.dumps(windows))
    assert isinstance(again, base)
    assert isinstance(again, Windows)


def expected_sums(windows):
    return [int(window["data/tactile_image"].sum()) for window in windows]


def sums(connection, windows):
    connection.send([int(windows[i]["data/tactile_image"].sum()) for i in range(len(windows))])


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_forked_workers_open_the_shards_again(folder):
    windows = taxelsim.Dataset(folder).windows(13, columns=["data/tactile_image"])
    expected = expected_sums(windows)  # the parent has the shards open
    shards = windows.dataset._shards
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)

    def work():
        before = next(iter(shards._open.values()))
        sums(sender, windows)
        sender.send(all(shard is not before for shard in shards._open.values()))

    workers = [context.Process(target=work) for _ in range(2)]
    for worker in workers:
        worker.start()
    received = [receiver.recv() for _ in range(4)]
    for worker in workers:
        worker.join(10)
    assert received.count(expected) == 2
    assert received.count(True) == 2


def test_spawned_workers_read_pickled_windows(generated):
    windows = taxelsim.Dataset(generated["compressed"]).windows(13, columns=["data/tactile_image"])
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        received = pool.starmap(operator.getitem, [(windows, i) for i in range(len(windows))])
    assert [int(window["data/tactile_image"].sum()) for window in received] == expected_sums(windows)


def test_a_pickled_data_set_is_not_verified_again(copied, compared, monkeypatch):
    data = taxelsim.Dataset(copied, cache_bytes=12345)
    data["data/time"][:]
    text = pickle.dumps(data)
    monkeypatch.setattr(checksums, "_verified", {})  # as in another process
    compared.clear()
    again = pickle.loads(text)
    np.testing.assert_array_equal(again["data/time"], data["data/time"])
    assert not any(compared)
    assert again._cache_bytes == 12345


def test_a_data_set_that_was_replaced_after_pickling_is_refused(copied, generated):
    text = pickle.dumps(taxelsim.Dataset(copied))
    for file in copied.iterdir():
        file.write_bytes((generated["compressed"] / file.name).read_bytes())
    with pytest.raises(taxelsim.InputError, match="another one than when this object was pickled"):
        pickle.loads(text)


def test_threads_read_the_same_data_set(folder):
    data = taxelsim.Dataset(folder, cache_bytes=4000)
    images = data["data/tactile_image"][:]
    fresh = taxelsim.Dataset(folder, cache_bytes=4000)
    rows = np.random.default_rng(2).integers(130, size=(400, 5))
    with ThreadPoolExecutor(8) as pool:
        for index, values in zip(rows, pool.map(fresh["data/tactile_image"].__getitem__, rows), strict=True):
            np.testing.assert_array_equal(values, images[index])
