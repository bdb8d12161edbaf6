"""Exports read by the programs that they are for, compared with the data set, and policies trained on them.

Not collected by default: needs python/requirements/readers.txt and the exports that scripts/campaign makes in build/exports.
"""

from pathlib import Path

import numpy as np
import pytest
import torch

import taxelsim
from taxelsim.pictures import TACTILE_IMAGE, range_of, tactile_pictures

EXPORTS = Path(__file__).resolve().parents[3] / "build/exports"
BATCH = 64
VIDEO_TOLERANCE = 6  # levels of a colour, mean: x264 at this quality, as in test_video.py


@pytest.fixture(scope="module")
def data() -> taxelsim.Dataset:
    return taxelsim.Dataset(EXPORTS / "data")


def assert_learns(losses: list[float]) -> None:
    """The loss of the last tenth of an epoch is below that of the first tenth."""
    tenth = len(losses) // 10
    assert np.isfinite(losses).all()
    assert np.mean(losses[-tenth:]) < 0.9 * np.mean(losses[:tenth])


def test_lerobot_reads_every_frame(data):
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    root = EXPORTS / "lerobot"
    dataset = LeRobotDataset("local/lerobot", root=root)
    assert (len(dataset), dataset.num_episodes, dataset.fps) == (data.num_frames, data.num_episodes, 100)
    names = {"observation.tactile": "data/tactile_image", "observation.state": "data/sensor_pose", "action": "data/action"}
    table = dataset.hf_dataset.with_format("numpy")
    for name, column in names.items():
        np.testing.assert_array_equal(table[name][:], data[column][:].reshape(data.num_frames, -1).astype(np.float32))
    ends = data.episode_ends
    success = table["next.success"][:]
    np.testing.assert_array_equal(success[ends - 1], data["meta/success"][:] == 1)
    assert success.sum() == data["meta/success"][:].sum()
    for frame in (0, ends[2] - 1, ends[2], data.num_frames - 1):
        episode = int(np.searchsorted(ends, frame, side="right"))
        item = dataset[int(frame)]
        assert item["task"] == f"servo_mix: {data['meta/object_name'][episode]}"
        assert item["episode_index"] == episode
    stats = dataset.meta.stats["observation.tactile"]
    np.testing.assert_allclose(stats["mean"], data["data/tactile_image"][:].reshape(data.num_frames, -1).mean(0))


def test_lerobot_reads_windows_inside_episodes(data):
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    dataset = LeRobotDataset("local/lerobot", root=EXPORTS / "lerobot", delta_timestamps={"action": [0.0, 0.01, 0.02]})
    end = int(data.episode_ends[0])
    item = dataset[end - 2]
    np.testing.assert_array_equal(item["action"].numpy(), data["data/action"][[end - 2, end - 1, end - 1]])
    assert item["action_is_pad"].tolist() == [False, False, True]


def test_lerobot_decodes_the_video_of_the_array(data):
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    dataset = LeRobotDataset("local/video", root=EXPORTS / "lerobot_video", video_backend="pyav")  # torchcodec needs FFmpeg's libraries
    key = "observation.images.tactile"
    assert dataset.meta.video_keys == [key]
    assert dataset.meta.stats[key]["mean"].shape == (3, 1, 1)
    sensor = taxelsim.load_scene(taxelsim.SCENES / "servo_mix.yaml").sensor
    ends = data.episode_ends
    for frame in (0, 1, ends[0] - 1, ends[0], ends[7] + 11, data.num_frames - 1):
        expected = tactile_pictures(sensor, data[TACTILE_IMAGE][int(frame)][None], range_of(data, TACTILE_IMAGE))[0]
        found = 255 * dataset[int(frame)][key].numpy().transpose(1, 2, 0)
        assert np.abs(found - expected).mean() < VIDEO_TOLERANCE


def test_lerobot_reads_windows_of_touch_and_points(data):
    """Each frame has the five frames of the data set up to it, with their times; the forces of points add up to its force."""
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    dataset = LeRobotDataset("local/windows", root=EXPORTS / "lerobot_windows")
    k = 5
    assert (dataset.fps, len(dataset)) == (20, data.num_frames // k)
    table = dataset.hf_dataset.with_format("numpy")
    images = data["data/tactile_image"][:].reshape(-1, k, 84).astype(np.float32)
    np.testing.assert_array_equal(np.stack(table["observation.tactile_window"][:]), images)
    np.testing.assert_array_equal(np.stack(table["observation.tactile"][:]), images[:, -1])
    np.testing.assert_allclose(np.stack(table["observation.window_time"][:]), data["data/time"][:].reshape(-1, k), rtol=1e-6)
    wrench = data["data/ground_truth/contact_wrench"][:].reshape(-1, k, 6)
    np.testing.assert_array_equal(np.stack(table["observation.wrench_window"][:]), wrench)
    forces = np.stack(table["observation.tactile_points"][:])[..., 6].sum(1)
    np.testing.assert_allclose(forces, data["data/total_force"][:][k - 1 :: k], rtol=1e-4, atol=1e-4)
    assert dataset.meta.stats["observation.tactile_window"]["mean"].shape == (k, 84)
    item = dataset[7]
    assert (tuple(item["observation.tactile_window"].shape), item["task"]) == ((k, 84), f"servo_mix: {data['meta/object_name'][0]}")


def test_a_policy_that_reads_the_window_trains_one_epoch():
    """Convolutions over the frames of the window; the stock policies read no feature of this name."""
    from lerobot.datasets.lerobot_dataset import LeRobotDataset, LeRobotDatasetMetadata
    from lerobot.datasets.utils import dataset_to_policy_features
    from lerobot.policies.act.configuration_act import ACTConfig

    root = EXPORTS / "lerobot_windows"
    features = dataset_to_policy_features(LeRobotDatasetMetadata("local/windows", root=root).features)
    config = ACTConfig(input_features={name: feature for name, feature in features.items() if name != "action"})
    assert "observation.tactile_window" in config.input_features
    assert (config.robot_state_feature, config.env_state_feature) == (features["observation.state"], None)  # all that ACT reads of numbers
    torch.manual_seed(1)
    dataset = LeRobotDataset("local/windows", root=root)
    stats = {
        name: {key: torch.tensor(value) for key, value in dataset.meta.stats[name].items()}
        for name in ("observation.tactile_window", "action")
    }
    network = torch.nn.Sequential(
        torch.nn.Conv1d(84, 32, 3),
        torch.nn.ReLU(),
        torch.nn.Flatten(),
        torch.nn.Linear(3 * 32, 64),
        torch.nn.ReLU(),
        torch.nn.Linear(64, 6),
    )
    optimizer = torch.optim.Adam(network.parameters(), lr=3e-3)
    losses = []
    for batch in torch.utils.data.DataLoader(dataset, batch_size=16, shuffle=True):
        window, action = ((batch[name] - stats[name]["mean"]) / (stats[name]["std"] + 1e-6) for name in stats)
        loss = torch.nn.functional.mse_loss(network(window.float().transpose(1, 2)), action.float())
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        losses.append(loss.item())
    assert_learns(losses)


def test_act_of_lerobot_trains_one_epoch():
    from lerobot.configs.types import FeatureType
    from lerobot.datasets.lerobot_dataset import LeRobotDataset, LeRobotDatasetMetadata
    from lerobot.datasets.utils import dataset_to_policy_features
    from lerobot.policies.act.configuration_act import ACTConfig
    from lerobot.policies.act.modeling_act import ACTPolicy
    from lerobot.policies.factory import make_pre_post_processors

    torch.manual_seed(1)
    root, chunk = EXPORTS / "lerobot_environment_state", 5
    meta = LeRobotDatasetMetadata("local/act", root=root)
    features = dataset_to_policy_features(meta.features)
    config = ACTConfig(
        input_features={name: feature for name, feature in features.items() if feature.type is not FeatureType.ACTION},
        output_features={name: feature for name, feature in features.items() if feature.type is FeatureType.ACTION},
        chunk_size=chunk,
        n_action_steps=chunk,
        dim_model=64,
        n_heads=4,
        dim_feedforward=128,
        n_encoder_layers=1,
        use_vae=False,
        device="cpu",
    )
    assert set(config.input_features) == {"observation.environment_state", "observation.state"}
    policy = ACTPolicy(config)
    prepare, _ = make_pre_post_processors(config, dataset_stats=meta.stats)
    dataset = LeRobotDataset("local/act", root=root, delta_timestamps={"action": [k / meta.fps for k in range(chunk)]})
    optimizer = torch.optim.Adam(policy.parameters(), lr=1e-3)
    losses = []
    for batch in torch.utils.data.DataLoader(dataset, batch_size=BATCH, shuffle=True):
        loss, _ = policy.forward(prepare(batch))
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        losses.append(loss.item())
    assert_learns(losses)


def test_zarr_2_reads_the_buffer_and_a_network_trains_one_epoch(data):
    import zarr

    assert zarr.__version__.startswith("2.")
    root = zarr.open(str(EXPORTS / "zarr"), mode="r")
    np.testing.assert_array_equal(root["meta/episode_ends"][:], data.episode_ends)
    for array in root["data"].values():  # as the replay buffers of Diffusion Policy check it
        assert array.shape[0] == root["meta/episode_ends"][-1]
    np.testing.assert_array_equal(root["data/tactile"][:], data["data/tactile_image"][:])
    np.testing.assert_array_equal(root["data/action"][:], data["data/action"][:])
    torch.manual_seed(1)
    inputs = np.concatenate((root["data/tactile"][:].reshape(data.num_frames, -1).astype(np.float32), root["data/state"][:]), axis=1)
    inputs, targets = (torch.from_numpy((x - x.mean(0)) / (x.std(0) + 1e-6)) for x in (inputs, root["data/action"][:]))
    network = torch.nn.Sequential(torch.nn.Linear(inputs.shape[1], 64), torch.nn.Tanh(), torch.nn.Linear(64, targets.shape[1]))
    optimizer = torch.optim.Adam(network.parameters(), lr=1e-3)
    losses = []
    for batch in torch.randperm(data.num_frames).split(BATCH):
        loss = torch.nn.functional.mse_loss(network(inputs[batch]), targets[batch])
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        losses.append(loss.item())
    assert_learns(losses)


def test_zarr_2_reads_open_x_tactile_by_side_group_and_area():
    """The columns that FTP-1's loader takes; the loader itself is not on PyPI."""
    import zarr

    root, data = zarr.open(str(EXPORTS / "grasp.zarr"), mode="r"), taxelsim.Dataset(EXPORTS / "grasp")
    arrays = root["data"]
    for array in arrays.values():  # as its replay buffers check it
        assert array.shape[0] == root["meta/episode_ends"][-1] == data.num_frames
    pads = {"left": ("right", "fingertip_6x4", 0), "right": ("left", "wts0614_soft_cover", 0), "below": ("right", "fingertip_6x4", 1)}
    for name, (side, group, index) in pads.items():
        np.testing.assert_array_equal(arrays[f"{side}_tactile_data_{group}"][:, index], data[f"data/{name}/tactile_image"][:])
        assert arrays[f"{side}_tactile_type_{group}"][-1] == "state"
        assert arrays[f"{side}_tactile_sensor_{group}"][-1] == group
    assert arrays["right_tactile_area_fingertip_6x4"][-1].astype(np.int32).tolist() == [0, 2]
    assert arrays["left_tactile_area_wts0614_soft_cover"][-1].astype(np.int32).tolist() == [1]
    slots = np.zeros((data.num_frames, 2, 32))  # as it scatters joints to slots
    for index, side in enumerate(("right", "left")):
        slots[:, index, arrays[f"{side}_hand_joints_idx"][-1].astype(np.int32)] = arrays[f"{side}_hand_joints"][:]
    np.testing.assert_array_equal(np.stack([slots[:, 0, 28], slots[:, 1, 7]], axis=1), data["data/robot/joint_position"][:])
    assert str(arrays["sub_task_instruction"][0]) == "gripper_grasp: box"
    assert arrays["camera_main_rgb"][0].shape[-1] == 3


@pytest.mark.parametrize("mask", ["train", "valid"])
def test_robomimic_reads_every_sequence(data, mask):
    from robomimic.utils import file_utils, obs_utils
    from robomimic.utils.dataset import SequenceDataset

    file = str(EXPORTS / "robomimic.hdf5")
    obs_utils.initialize_obs_utils_with_obs_specs({"obs": {"low_dim": ["tactile", "state"]}})
    shapes = file_utils.get_shape_metadata_from_dataset(file)
    assert (shapes["ac_dim"], shapes["all_shapes"]["tactile"]) == (6, [84])
    assert file_utils.get_env_metadata_from_dataset(file)["env_name"] == "servo_mix"
    keys = ("actions", "rewards", "dones")
    dataset = SequenceDataset(file, ("tactile", "state"), keys, seq_length=3, hdf5_cache_mode="low_dim", filter_by_attribute=mask)
    chosen = [k for k in range(data.num_episodes) if (k % 10 == 9) == (mask == "valid")]
    assert dataset.demos == [f"demo_{k}" for k in chosen]
    first = 0
    for episode in map(data.episode, chosen):
        length = len(episode["data/time"])
        last = dataset[first + length - 1]  # padded with itself
        np.testing.assert_array_equal(last["actions"], episode["data/action"][[-1, -1, -1]])
        item = dataset[first + 5]
        np.testing.assert_array_equal(item["obs"]["tactile"], episode["data/tactile_image"][5:8].reshape(3, -1))
        np.testing.assert_array_equal(item["next_obs"]["tactile"], episode["data/tactile_image"][6:9].reshape(3, -1))
        np.testing.assert_array_equal(last["rewards"][0], episode["meta/success"])
        assert (last["dones"][0], item["dones"][0]) == (1, 0)
        first += length
    assert len(dataset) == first


def test_rosbags_decodes_every_message(data):
    from rosbags.highlevel import AnyReader

    for number in range(data.num_episodes):
        episode = data.episode(number)
        with AnyReader([EXPORTS / f"mcap/episode-{number:06d}.mcap"]) as reader:
            assert len(reader.connections) == 5
            for connection in reader.connections:
                messages = [reader.deserialize(raw, connection.msgtype) for _, _, raw in reader.messages([connection])]
                assert len(messages) == len(episode["data/time"])
                if connection.topic == "/tactile/image":
                    pixels = [np.frombuffer(message.data, "<u2").reshape(6, 14) for message in messages]
                    np.testing.assert_array_equal(pixels, episode["data/tactile_image"])
                if connection.topic == "/tactile/contact_wrench":
                    force = [message.wrench.force.z for message in messages]
                    np.testing.assert_array_equal(force, episode["data/ground_truth/contact_wrench"][:, 2])
