"""robomimic: groups, attributes and masks that its SequenceDataset reads."""

import json

import numpy as np
import pytest

import taxelsim
from taxelsim.export import export

from .conftest import NUM_EPISODES, NUM_FRAMES

h5py = pytest.importorskip("h5py")


def test_episodes_are_those_of_the_data_set(folder, exported):
    data = taxelsim.Dataset(folder)
    with h5py.File(exported("robomimic", columns=("data/total_force",), next_observations=True)) as file:
        assert file["data"].attrs["total"] == NUM_EPISODES * NUM_FRAMES
        assert json.loads(file["data"].attrs["env_args"]) == {"env_name": "short", "type": 2, "env_kwargs": {}}
        assert set(file["data"]) == {f"demo_{k}" for k in range(NUM_EPISODES)}
        for k in range(NUM_EPISODES):
            demo, episode = file[f"data/demo_{k}"], data.episode(k)
            assert demo.attrs["num_samples"] == NUM_FRAMES
            images = episode["data/tactile_image"].reshape(NUM_FRAMES, -1)
            np.testing.assert_array_equal(demo["actions"], episode["data/action"])
            np.testing.assert_array_equal(demo["obs/tactile"], images)
            np.testing.assert_array_equal(demo["obs/state"], episode["data/sensor_pose"].astype(np.float32))
            np.testing.assert_array_equal(demo["obs/total_force"], episode["data/total_force"][:, None])
            np.testing.assert_array_equal(demo["next_obs/tactile"], [*images[1:], images[-1]])
            np.testing.assert_array_equal(demo["dones"], np.arange(NUM_FRAMES) == NUM_FRAMES - 1)
            np.testing.assert_array_equal(demo["rewards"], demo["dones"][:] * episode["meta/success"])


@pytest.mark.parametrize(("episodes", "valid"), [(None, ["demo_9"]), ((0, 2), ["demo_2"])])
def test_masks_divide_the_episodes(exported, episodes, valid):
    with h5py.File(exported("robomimic", episodes=episodes)) as file:
        names = {mask: [name.decode() for name in file[f"mask/{mask}"][:]] for mask in ("train", "valid")}
        assert names["valid"] == valid
        assert sorted(names["train"] + valid) == sorted(file["data"])
        assert "next_obs" not in file["data/demo_0"]


def test_an_interrupted_export_begins_again_to_the_same_bytes(folder, exported, tmp_path):
    whole = exported("robomimic", "whole").read_bytes()

    def stop(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        export(folder, tmp_path / "resumed", "robomimic", on_progress=stop)
    assert not (tmp_path / "resumed").exists()
    assert (tmp_path / "resumed.incomplete").exists()
    export(folder, tmp_path / "resumed", "robomimic")
    assert (tmp_path / "resumed").read_bytes() == whole
    assert not (tmp_path / "resumed.incomplete").exists()


def test_actions_are_needed(folder, tmp_path, monkeypatch):
    monkeypatch.setattr("taxelsim.export.source.ACTION", "data/nothing")
    with pytest.raises(taxelsim.InputError, match="no column data/action, which robomimic needs: record actions in the scene"):
        export(folder, tmp_path / "out", "robomimic")
