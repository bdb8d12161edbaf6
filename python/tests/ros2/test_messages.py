"""Messages and topics without DDS: the type store of rosbags has the same definitions and hashes, and decodes the same fields."""

import sys

import numpy as np
import pytest

import taxelsim
from taxelsim.commands import ros2
from taxelsim.ros2.messages import TYPE_HASHES, TYPES, definition_of
from taxelsim.ros2.topics import namespace_of, topics_of

typesys = pytest.importorskip("rosbags.typesys")

RELEASES = [typesys.Stores.ROS2_HUMBLE, typesys.Stores.ROS2_JAZZY, typesys.Stores.ROS2_KILTED]


@pytest.mark.parametrize("release", RELEASES)
def test_definitions_and_hashes_are_those_of_ros_2(release):
    store = typesys.get_typestore(release)
    for name in TYPES:
        full = name.replace("/", "/msg/")
        for found, (_, fields) in typesys.get_types_from_msg(definition_of(name), full).items():
            assert fields == store.fielddefs[found][1], (name, found)
    for name, found in TYPE_HASHES.items():
        assert store.hash_rihs01(name.replace("/", "/msg/")) == f"RIHS01_{found}"


def test_a_frame_without_contact_has_no_contact_pose(model):
    frame = taxelsim.Simulator(model).read().copy()
    contents = {topic.name: topic.content(frame, 0) for topic in topics_of(model.sensor)}
    assert contents["contact_pose"] is None
    assert contents["image"]["data"] == bytes(168)
    assert contents["contact_wrench"]["wrench"]["force"] == {"x": 0, "y": 0, "z": 0}


def test_the_contact_pose_turns_with_the_patch(device):
    """The edge angle is about z of the patch, whose frame is turned by 30 degrees about x of S."""
    base = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    X_SP = taxelsim.Pose(position=[0, 0, 0.01], rotation=taxelsim.axis_angle([1, 0, 0], np.pi / 6))
    sensor = base.replace(patches=[base.patches[0].replace(X_SP=X_SP)])
    simulator = taxelsim.Simulator(taxelsim.Model(device, sensor, [taxelsim.Box([0.02, 0.002, 0.002])]))
    X_PO = taxelsim.Pose(position=[0, 0, 0.0007], rotation=taxelsim.axis_angle([0, 0, 1], np.pi / 4))
    X_SO = X_SP * X_PO
    simulator.set_objects(0, [[*X_SO.position, *X_SO.rotation]])
    simulator.step(0.01)
    frame = simulator.read()
    q = next(topic for topic in topics_of(sensor) if topic.name == "contact_pose").content(frame, 0)["pose"]["orientation"]
    expected = taxelsim.Pose(rotation=X_SO.rotation).transform([1, 0, 0])  # the long side of the box, in S
    axis = taxelsim.Pose(rotation=[q["w"], q["x"], q["y"], q["z"]]).transform([1, 0, 0])
    assert abs(np.dot(axis, expected)) > np.cos(np.deg2rad(3))  # a pitch of 3.4 mm finds the angle of a bar of 20 mm that well


def test_names_of_sensors_are_parts_of_topics():
    assert namespace_of("") == "/tactile"
    assert namespace_of("left_thumb2") == "/tactile/left_thumb2"
    for name in ("0", "a/b", "a__b", "_a", "a_", "a-b", "ä", "a b", "a" * 201):
        with pytest.raises(taxelsim.InputError, match=r"^sensor '.+ is not allowed as a part of a topic"):
            namespace_of(name)


def test_the_command_names_the_missing_package(monkeypatch, capfd):
    for name in ("bridge", "dds"):
        monkeypatch.delitem(sys.modules, f"taxelsim.ros2.{name}", raising=False)
    monkeypatch.setitem(sys.modules, "cyclonedds.core", None)
    assert ros2.main([str(taxelsim.SCENES / "edge_servo.yaml")]) == 2
    assert capfd.readouterr().err.endswith(": the bridge needs cyclonedds: pip install 'taxelsim[ros2]'\n")
