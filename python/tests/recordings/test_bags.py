"""Bags of ROS that the package rosbags wrote, as measurements."""

import importlib

import numpy as np
import pytest

import taxelsim
from taxelsim.recordings import Measurement, read_bag, write_measurement

rosbag2 = pytest.importorskip("rosbags.rosbag2")
rosbag1 = pytest.importorskip("rosbags.rosbag1")
typesys = pytest.importorskip("rosbags.typesys")

SENSOR = taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml"
ROWS = 4
IMAGES = np.arange(ROWS * 84, dtype=np.uint16).reshape(ROWS, 6, 14)
CUSTOM = "std_msgs/Header header\nfloat32[] values\nuint8 status\nstring label\n"


def messages_of(types, row, stamp):
    """An image, a wrench, an array with two dimensions and a message of a vendor, of a row."""
    header = {"stamp": types["builtin_interfaces/msg/Time"](sec=stamp, nanosec=500_000_000), "frame_id": "sensor"}
    if "std_msgs/msg/Header" in types and "seq" in types["std_msgs/msg/Header"].__dataclass_fields__:
        header["seq"] = row
    header = types["std_msgs/msg/Header"](**header)
    vector, dimension = types["geometry_msgs/msg/Vector3"], types["std_msgs/msg/MultiArrayDimension"]
    padded = np.zeros((6, 30), np.uint8)  # two bytes more than a row of pixels
    padded[:, :28] = IMAGES[row].astype(">u2").view(np.uint8).reshape(6, 28)
    force = types["geometry_msgs/msg/Wrench"](force=vector(x=0.0, y=0.0, z=-float(row)), torque=vector(x=0.0, y=0.0, z=0.0))
    layout = types["std_msgs/msg/MultiArrayLayout"](
        dim=[dimension(label="rows", size=2, stride=6), dimension(label="columns", size=3, stride=3)], data_offset=0
    )
    pixels = {"height": 6, "width": 14, "encoding": "mono16", "is_bigendian": 1, "step": 30, "data": padded.ravel()}
    return {
        "/image": types["sensor_msgs/msg/Image"](header=header, **pixels),
        "/ft": types["geometry_msgs/msg/WrenchStamped"](header=header, wrench=force),
        "/pad": types["std_msgs/msg/Float32MultiArray"](layout=layout, data=np.arange(6, dtype=np.float32) + row),
        "/vendor": types["vendor_msgs/msg/Touch"](header=header, values=np.float32([row, row + 1]), status=row, label="thumb"),
    }


@pytest.fixture(params=["ros2", "ros1"])
def bag(request, tmp_path):
    """A bag with four messages on each of four topics, 10 ms apart, those of /ft 5 ms before and none before the first image."""
    is_new = request.param == "ros2"
    store = typesys.get_typestore(typesys.Stores.LATEST if is_new else typesys.Stores.ROS1_NOETIC)
    store.register(typesys.get_types_from_msg(CUSTOM, "vendor_msgs/msg/Touch"))
    path = tmp_path / ("session" if is_new else "session.bag")
    with rosbag2.Writer(path, version=9) if is_new else rosbag1.Writer(path) as writer:
        connections = {}
        for row in range(ROWS):
            for topic, message in messages_of(store.types, row, 100 + row).items():
                if topic not in connections:
                    connections[topic] = writer.add_connection(topic, message.__msgtype__, typestore=store)
                serialize = store.serialize_cdr if is_new else store.serialize_ros1
                time = 1_000_000_000_000_000_000 + 10_000_000 * row + (5_000_000 if topic == "/ft" else 0)
                writer.write(connections[topic], time, bytes(serialize(message, message.__msgtype__)))
    return path


def test_images_with_the_last_force(bag, tmp_path):
    """The first image comes before the first force: its row is left out. Times are those of headers."""
    recording = read_bag(bag, ("/image", "/ft"))
    what = Measurement(
        "images", SENSOR, "/image.r{row}_c{col}", time="/image.stamp", quantities={"force_N": "-/ft.wrench.force.z"}, unit="counts"
    )
    table = write_measurement(recording, what, tmp_path / "out.yaml")
    rows = np.loadtxt(table, delimiter=",", skiprows=1)
    np.testing.assert_array_equal(rows[:, 0], [0, 1, 2])
    np.testing.assert_array_equal(rows[:, 1], [0, 1, 2])
    np.testing.assert_array_equal(rows[:, 2:], IMAGES[1:].reshape(-1, 84))


def test_fields_have_names(bag):
    pad = read_bag(bag, ("/pad",))
    assert pad.names == (*(f"/pad.r{row}_c{col}" for row in range(2) for col in range(3)), "/pad.stamp")
    np.testing.assert_array_equal(pad.column("r1_c2"), 5 + np.arange(ROWS))
    np.testing.assert_allclose(pad.column("stamp"), 0.01 * np.arange(ROWS), atol=1e-12)  # no header: times of recording
    vendor = read_bag(bag, ("/vendor",))
    assert vendor.names == ("/vendor.values.0", "/vendor.values.1", "/vendor.status", "/vendor.stamp")
    np.testing.assert_array_equal(vendor.column("status"), np.arange(ROWS))


def test_blocks_have_all_rows(bag, monkeypatch):
    monkeypatch.setattr("taxelsim.recordings.bags.BLOCK_ROWS", 3)
    recording = read_bag(bag, ("/vendor",))
    assert [len(block["status"]) for block in recording.blocks(["status"])] == [3, 1]


def test_what_a_bag_lacks_is_one_line(bag, tmp_path):
    with pytest.raises(taxelsim.InputError, match=r"--topic is needed, one of /ft, /image, /pad, /vendor$"):
        read_bag(bag)
    with pytest.raises(taxelsim.InputError, match="no topic '/touch'; it has /ft, /image, /pad, /vendor"):
        read_bag(bag, ("/touch",))
    with pytest.raises(taxelsim.InputError, match=r"the unit of /image\.r0_c0 is not stated"):
        write_measurement(read_bag(bag, ("/image",)), Measurement("images", SENSOR, "/image.r{row}_c{col}"), tmp_path / "out.yaml")
    broken = tmp_path / "broken.mcap"
    broken.write_bytes(b"no bag")
    with pytest.raises(taxelsim.InputError, match=r"^\S*broken\.mcap: no bag of ROS: .*$"):
        read_bag(broken)
    assert not list(tmp_path.glob("out.*"))


def test_lists_keep_their_length(tmp_path):
    store = typesys.get_typestore(typesys.Stores.LATEST)
    layout = store.types["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0)
    with rosbag2.Writer(tmp_path / "session", version=9) as writer:
        connection = writer.add_connection("/pad", "std_msgs/msg/Float32MultiArray", typestore=store)
        for time, size in enumerate((3, 3, 2)):
            message = store.types["std_msgs/msg/Float32MultiArray"](layout=layout, data=np.zeros(size, np.float32))
            writer.write(connection, time, bytes(store.serialize_cdr(message, message.__msgtype__)))
    with pytest.raises(taxelsim.InputError, match="/pad: message 2 has other sizes than the first one"):
        read_bag(tmp_path / "session").column("/pad.0")


def test_the_command_knows_a_bag(bag, tmp_path, capfd):
    main = importlib.import_module("taxelsim.commands.import").main
    arguments = [str(bag), "--sensor", str(SENSOR), "--measurement", "images", "--topic", "/image", "-o", str(tmp_path / "out.yaml")]
    assert main([*arguments, "--taxels", "/image.r{row}_c{col}", "--unit", "counts"]) == 0
    assert main([*arguments, "--episode", "1"]) == 2
    assert capfd.readouterr().err == "taxelsim import: --episode: not for bags of ROS\n"
