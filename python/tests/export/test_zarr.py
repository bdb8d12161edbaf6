"""Zarr: the layout of the replay buffers of Diffusion Policy, in both versions of the format."""

import numpy as np
import pytest

import taxelsim
from taxelsim.export import Options, export

from .conftest import NUM_EPISODES, NUM_FRAMES, files_of

zarr = pytest.importorskip("zarr")
replay_buffer = pytest.importorskip("taxelsim.export.replay_buffer")


@pytest.fixture(params=[2, 3])
def version(request):
    return request.param


@pytest.fixture
def small_pieces(monkeypatch):
    """Chunks of 25 frames with images of 168 bytes, shards of 50."""
    monkeypatch.setattr(replay_buffer, "CHUNK_BYTES", 25 * 168)
    monkeypatch.setattr(replay_buffer, "CHUNKS_PER_SHARD", 2)


@pytest.mark.usefixtures("small_pieces")
def test_arrays_are_those_of_the_data_set(folder, exported, version):
    data = taxelsim.Dataset(folder)
    root = zarr.open_group(exported("zarr", zarr_format=version, columns=("data/ground_truth/total_force",)), mode="r")
    assert root.metadata.zarr_format == version
    np.testing.assert_array_equal(root["meta/episode_ends"][:], NUM_FRAMES * np.arange(1, NUM_EPISODES + 1))
    np.testing.assert_array_equal(root["meta/success"][:], data["meta/success"][:])
    np.testing.assert_array_equal(root["data/tactile"][:], data["data/tactile_image"][:])
    np.testing.assert_array_equal(root["data/state"][:], data["data/sensor_pose"][:].astype(np.float32))
    np.testing.assert_array_equal(root["data/action"][:], data["data/action"][:])
    np.testing.assert_array_equal(root["data/timestamp"][:], data["data/time"][:])
    np.testing.assert_array_equal(root["data/ground_truth_total_force"][:, 0], data["data/ground_truth/total_force"][:])
    assert root["data/tactile"].dtype == np.uint16
    assert root["data/action"].attrs["names"] == ["v_x", "v_y", "v_z", "w_x", "w_y", "w_z"]
    assert root["data/tactile"].chunks == (25, 6, 14)
    assert root["data/tactile"].shards == (None if version == 2 else (50, 6, 14))


def test_chosen_episodes_count_from_zero(folder, exported):
    root = zarr.open_group(exported("zarr", episodes=(3, 4)), mode="r")
    np.testing.assert_array_equal(root["meta/episode_ends"][:], [NUM_FRAMES, 2 * NUM_FRAMES])
    np.testing.assert_array_equal(root["data/action"][:], taxelsim.Dataset(folder)["data/action"][3 * NUM_FRAMES : 5 * NUM_FRAMES])


@pytest.mark.usefixtures("small_pieces")
def test_an_interrupted_export_continues_to_the_same_bytes(folder, exported, tmp_path, version):
    options = Options(zarr_format=version)
    whole = files_of(exported("zarr", "whole", zarr_format=version))

    def stop(done, total):
        if done > 50:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        export(folder, tmp_path / "resumed", "zarr", options, stop)
    assert not (tmp_path / "resumed").exists()
    torn = tmp_path / "resumed.incomplete/data/tactile" / ("4.0.0" if version == 2 else "c/2/0/0")  # of the piece that comes next
    torn.parent.mkdir(parents=True, exist_ok=True)
    torn.write_bytes(b"torn")
    progress = []
    export(folder, tmp_path / "resumed", "zarr", options, lambda done, total: progress.append(done))
    assert progress[0] == 100
    assert files_of(tmp_path / "resumed") == whole
