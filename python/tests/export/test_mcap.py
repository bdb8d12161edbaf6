"""MCAP: messages that a reader of ROS 2 decodes from the definitions in the file."""

import numpy as np
import pytest

import taxelsim
from taxelsim.export import export

from .conftest import NUM_EPISODES, NUM_FRAMES, files_of

mcap_ros2 = pytest.importorskip("mcap_ros2.reader")
DecoderFactory = pytest.importorskip("mcap_ros2.decoder").DecoderFactory
make_reader = pytest.importorskip("mcap.reader").make_reader


def messages_of(file):
    """By topic: (frames), and times in ns."""
    topics, times = {}, {}
    for found in mcap_ros2.read_ros2_messages(str(file)):
        topics.setdefault(found.channel.topic, []).append(found.ros_msg)
        times.setdefault(found.channel.topic, []).append(found.log_time_ns)
    return topics, times


def test_messages_are_those_of_the_data_set(folder, exported):
    root = exported("mcap")
    assert len(list(root.glob("*.mcap"))) == NUM_EPISODES
    topics, times = messages_of(root / "episode-000003.mcap")
    episode = taxelsim.Dataset(folder).episode(3)
    names = ["action", "contact_wrench", "image", "object_pose", "sensor_pose"]
    assert sorted(topics) == [f"/tactile/{name}" for name in names]
    for name in topics:
        np.testing.assert_allclose(np.array(times[name]) / 1e9, episode["data/time"], atol=1e-9)  # rounded to nanoseconds
    images = topics["/tactile/image"]
    assert (images[0].height, images[0].width, images[0].step, images[0].encoding) == (6, 14, 28, "mono16")
    pixels = [np.frombuffer(bytes(image.data), "<u2").reshape(6, 14) for image in images]
    np.testing.assert_array_equal(pixels, episode["data/tactile_image"])
    pose = [(p.position, p.orientation) for p in (message.pose for message in topics["/tactile/object_pose"])]
    np.testing.assert_array_equal([(p.x, p.y, p.z, q.w, q.x, q.y, q.z) for p, q in pose], episode["data/pose"])
    wrench = [(w.force, w.torque) for w in (message.wrench for message in topics["/tactile/contact_wrench"])]
    expected = episode["data/ground_truth/contact_wrench"]
    np.testing.assert_array_equal([(f.x, f.y, f.z, t.x, t.y, t.z) for f, t in wrench], expected)
    twist = [(v.linear, v.angular) for v in (message.twist for message in topics["/tactile/action"])]
    np.testing.assert_array_equal([(v.x, v.y, v.z, w.x, w.y, w.z) for v, w in twist], episode["data/action"])
    header = topics["/tactile/sensor_pose"][7].header
    assert (header.frame_id, header.stamp.sec, header.stamp.nanosec) == ("world", 0, 70_000_000)


def test_metadata_names_the_episode(folder, exported):
    with (exported("mcap", episodes=(2, 3)) / "episode-000001.mcap").open("rb") as stream:
        (record,) = make_reader(stream, decoder_factories=[DecoderFactory()]).iter_metadata()
    success = taxelsim.Dataset(folder)["meta/success"][3]
    assert record.metadata == {"scene": "short", "meta/object_name": '"bar"', "meta/success": str(success)}


def test_an_interrupted_export_continues_to_the_same_bytes(folder, exported, tmp_path):
    whole = files_of(exported("mcap", "whole"))

    def stop(done, total):
        if done == 5 * NUM_FRAMES:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        export(folder, tmp_path / "resumed", "mcap", on_progress=stop)
    assert not (tmp_path / "resumed").exists()
    progress = []
    export(folder, tmp_path / "resumed", "mcap", on_progress=lambda done, total: progress.append(done))
    assert progress[0] == 5 * NUM_FRAMES
    assert files_of(tmp_path / "resumed") == whole
