"""Names and shapes of columns: several sensors, taxels without a grid, robots with joints."""

import numpy as np
import pytest

import taxelsim
from taxelsim.export import Options, export
from taxelsim.export.features import feature_of, state_of, tactile_of


def test_several_sensors_have_a_prefix(two_sensors):
    data = taxelsim.Dataset(two_sensors)
    tactile = tactile_of(data)
    assert tactile.names[:2] == ("s0_r0_c0", "s0_r0_c1")
    assert (tactile.names[84], len(tactile.names)) == ("s1_r0_c0", 168)
    state = state_of(data, (), with_tactile=True)
    names = ["robot.joint_position.0", "robot.joint_position.1", "sensor_pose.0_x", "sensor_pose.0_y"]
    assert list(state.names[:4]) == names
    assert (state.names[15], state.names[16], len(state.names)) == ("sensor_pose.1_qz", "s0_r0_c0", 16 + 168)
    assert feature_of(data, ("data/robot/joint_position",)).names == ("robot.joint_position.0", "robot.joint_position.1")


def test_vectors_have_the_order_of_the_names(two_sensors):
    data = taxelsim.Dataset(two_sensors)
    values = data.frames(slice(0, 13), ["data/robot/joint_position", "data/sensor_pose", "data/tactile_image"])
    vectors = state_of(data, (), with_tactile=True).vectors(values)
    assert vectors.dtype == np.float32
    np.testing.assert_array_equal(vectors[:, :2], values["data/robot/joint_position"].astype(np.float32))
    np.testing.assert_array_equal(vectors[:, 9], values["data/sensor_pose"][:, 1, 0].astype(np.float32))
    np.testing.assert_array_equal(vectors[:, 16 + 84], values["data/tactile_image"][:, 1, 0, 0])


def test_several_sensors_have_topics_of_their_own(two_sensors, tmp_path):
    read = pytest.importorskip("mcap_ros2.reader").read_ros2_messages
    export(two_sensors, tmp_path / "out", "mcap")
    data = taxelsim.Dataset(two_sensors)
    topics: dict[str, list] = {}
    for found in read(str(tmp_path / "out/episode-000001.mcap")):
        topics.setdefault(found.channel.topic, []).append(found.ros_msg)
    names = [f"/tactile_{k}/{name}" for k in (0, 1) for name in ("image", "object_pose", "sensor_pose")]
    assert sorted(topics) == sorted(["/tactile/action", *names])
    second = [message.pose.position.x for message in topics["/tactile_1/sensor_pose"]]
    np.testing.assert_array_equal(second, data["data/sensor_pose"][13:, 1, 0])
    assert topics["/tactile_1/image"][0].header.frame_id == "sensor_1"


def test_images_of_several_sensors_stay_apart(two_sensors, tmp_path):
    zarr = pytest.importorskip("zarr")
    pytest.importorskip("taxelsim.export.replay_buffer")
    export(two_sensors, tmp_path / "out", "zarr", Options(state=("data/robot/joint_position",)))
    root = zarr.open_group(tmp_path / "out", mode="r")
    assert root["data/tactile"].shape == (26, 2, 6, 14)
    assert root["data/state"].shape == (26, 2)
