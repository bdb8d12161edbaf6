"""The bridge and a node of Cyclone DDS in another process, whose types and decoder are those of rosbags. For the campaign `ros2`."""

import os
import pickle
import signal
import socket
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

import taxelsim
from taxelsim.commands import ros2
from taxelsim.ros2.bridge import MAX_DISTANCE, Bridge

NODE = Path(__file__).with_name("node.py")
STORE = get_typestore(Stores.ROS2_JAZZY)
POSE = "geometry_msgs/msg/PoseStamped"
SCHEMAS = {
    "image": "sensor_msgs/msg/Image",
    "taxels": "sensor_msgs/msg/PointCloud2",
    "contact_wrench": "geometry_msgs/msg/WrenchStamped",
    "contact_pose": POSE,
}
SECOND = 10**9  # ns; stamps before it are of messages for discovery
NUM_FRAMES = 40
PATIENCE = 60.0  # s
DOMAIN = 90
LOAD_TOLERANCE = 2e-3  # N, 1e-3 of the load: to this the device searches for it
PROGRAM = "import sys; from taxelsim.commands.ros2 import main; sys.exit(main(sys.argv[1:]))"
SCENE = f"""
format_version: 1
name: press
kind: servo
sensor: {taxelsim.SCENES}/sensors/wts0614_soft_cover.yaml
objects: [{{cylinder: {{radius_mm: 8, length_mm: 40}}, orientation: {{rpy_deg: [90, 0, 0]}}}}]
episode: {{num_steps: 2, simulation_rate: 100}}
randomization: {{load: 2}}
controller: {{tactile_servo: {{total_force: {{kp: 1}}}}}}
"""


@contextmanager
def node(*arguments, **options):
    with subprocess.Popen([sys.executable, NODE, *map(str, arguments)], stdout=subprocess.PIPE, text=True, **options) as process:
        try:
            yield process
        finally:
            process.kill()


@pytest.fixture
def command(tmp_path):
    """The words of the command, for a scene with a press of 2 N."""
    (tmp_path / "scene.yaml").write_text(SCENE)
    return [sys.executable, "-c", PROGRAM, str(tmp_path / "scene.yaml"), "--domain", str(DOMAIN)]


def wait_until(found):
    end = time.monotonic() + PATIENCE
    while not (result := found()):
        assert time.monotonic() < end
        time.sleep(0.02)
    return result


def published(bridge, file, topics, frames):
    """What the node received: each of `frames` is published with its number as the nanoseconds of its stamp."""
    names = [word for topic, schema in topics.items() for word in (schema, topic)]
    with node("echo", DOMAIN, file, len(frames), *names) as echo:
        os.set_blocking(echo.stdout.fileno(), False)
        wait_until(lambda: echo.stdout.readline() or bridge.publish(frames[0], stamp=0))
        for k, frame in enumerate(frames):
            bridge.publish(frame, stamp=SECOND + k)
        assert echo.wait(PATIENCE) == 0
    return pickle.loads(file.read_bytes())


@pytest.fixture(scope="module")
def frames(model):
    """A cylinder that is pressed deeper and turned."""
    simulator = taxelsim.Simulator(model)
    frames = []
    for k in range(NUM_FRAMES):
        half = 0.5 * np.deg2rad(2 * k)
        rotation = np.sqrt(0.5) * np.array([np.cos(half), np.cos(half), np.sin(half), np.sin(half)])  # about x by 90 degrees, then about z
        simulator.set_objects(0, [[0.001, 0.002, 0.0079 - 1e-5 * k, *rotation]])
        simulator.step(0.01)
        frames.append(simulator.read().copy())
    assert all(frame.total_force[0] > 0 for frame in frames)
    return frames


@pytest.fixture
def bridge(sensor):
    with Bridge(sensor, domain=DOMAIN, allow_input=True) as bridge:
        yield bridge


def test_a_node_of_ros_2_receives_each_frame_of_the_simulator(bridge, sensor, frames, tmp_path):
    received = published(bridge, tmp_path / "out", {f"/tactile/{name}": schema for name, schema in SCHEMAS.items()}, frames)["messages"]
    for name in SCHEMAS:
        assert [stamp for stamp, _, _ in received[f"/tactile/{name}"]] == [SECOND + k for k in range(NUM_FRAMES)], name
    of = {name: [message for _, _, message in received[f"/tactile/{name}"]] for name in SCHEMAS}
    assert {message["header"]["frame_id"] for messages in of.values() for message in messages} == {"sensor"}
    newtons = np.array([taxelsim.nominal_force(sensor.readout, float(count)) for count in range(sensor.readout.saturation + 1)], np.float32)
    for k, frame in enumerate(frames):
        image = of["image"][k]
        assert (image["height"], image["width"], image["step"], image["encoding"]) == (6, 14, 28, "mono16")
        np.testing.assert_array_equal(image["data"].view("<u2").reshape(6, 14), frame.tactile_image[0])
        cloud = of["taxels"][k]
        fields = [(field["name"], field["offset"], field["datatype"], field["count"]) for field in cloud["fields"]]
        assert fields == [("x", 0, 7, 1), ("y", 4, 7, 1), ("z", 8, 7, 1), ("normal_force", 12, 7, 1)]  # 7: FLOAT32
        assert (cloud["height"], cloud["width"], cloud["point_step"], cloud["row_step"], cloud["is_dense"]) == (1, 84, 16, 84 * 16, True)
        points = cloud["data"].view("<f4").reshape(84, 4)
        np.testing.assert_array_equal(points[:, :3], np.float32(sensor.taxel_positions))
        np.testing.assert_array_equal(points[:, 3], newtons[frame.tactile_image[0].ravel()])
        wrench = of["contact_wrench"][k]["wrench"]
        found = [wrench[part][axis] for part in ("force", "torque") for axis in "xyz"]
        np.testing.assert_array_equal(found, frame.ground_truth.contact_wrench[0])
        pose = of["contact_pose"][k]["pose"]
        np.testing.assert_array_equal([pose["position"][axis] for axis in "xyz"], frame.center_of_pressure[0])
        q = pose["orientation"]
        assert (q["x"], q["y"]) == (0, 0)
        assert 2 * np.arctan2(q["z"], q["w"]) == pytest.approx(float(frame.edge_angle[0]), abs=1e-12)


def test_discovery_shows_the_endpoints_of_ros_2(bridge, frames, tmp_path):
    """Names and QoS are those of rmw_cyclonedds_cpp (create_readwrite_qos() and the default profile), hashes those of rosbags."""
    found = published(bridge, tmp_path / "out", {"/tactile/image": SCHEMAS["image"]}, frames[:1])["endpoints"]
    hashes = {schema: f"typehash={STORE.hash_rihs01(schema)};" for schema in SCHEMAS.values()}
    types = {schema: schema.replace("/msg/", "::msg::dds_::") + "_" for schema in SCHEMAS.values()}
    qos = (
        "Policy.Reliability.Reliable(max_blocking_time=9223372036854775807)",
        "Policy.History.KeepLast(depth=10)",
        "Policy.Durability.Volatile",
    )
    assert sorted(found["writers"]) == sorted((f"rt/tactile/{name}", types[of], *qos, hashes[of]) for name, of in SCHEMAS.items())
    input_qos = ("Policy.Reliability.BestEffort", "Policy.History.KeepLast(depth=1)", "Policy.Durability.Volatile")
    assert found["readers"] == [("rt/tactile/cmd_object_pose", types[POSE], *input_qos, hashes[POSE])]


def test_without_allow_input_there_is_no_reader(sensor, frames, tmp_path):
    with Bridge(sensor, domain=DOMAIN) as bridge:
        found = published(bridge, tmp_path / "out", {"/tactile/image": SCHEMAS["image"]}, frames[:1])["endpoints"]
        assert bridge.take_poses() == {}
    assert len(found["writers"]) == len(SCHEMAS)
    assert found["readers"] == []


def test_several_sensors_have_namespaces_and_three_axis_taxels_a_topic(device, sensor, frames, tmp_path):
    thumb = taxelsim.load_sensor(taxelsim.SCENES / "sensors/uskin_like_4x4.yaml")
    outputs = taxelsim.OutputOptions(taxel_counts=True)
    simulator = taxelsim.Simulator(taxelsim.Model(device, thumb, [taxelsim.Sphere(0.01)]), image_unit="newtons", outputs=outputs)
    simulator.set_objects(0, [[0, 0, 0, 1, 0, 0, 0]], anchor=[0.001, 0, -0.009])
    simulator.step(0.01)
    frame = simulator.read()
    topics = {
        "/tactile/thumb/image": SCHEMAS["image"],
        "/tactile/thumb/taxels": SCHEMAS["taxels"],
        "/tactile/thumb/taxel_counts": SCHEMAS["image"],
        "/tactile/index/image": SCHEMAS["image"],
    }
    with Bridge({"thumb": thumb, "index": sensor}, domain=DOMAIN) as bridge:
        received = published(bridge, tmp_path / "out", topics, [{"thumb": frame, "index": frames[0]}])["messages"]
    message = {topic: received[topic][0][2] for topic in topics}
    assert message["/tactile/thumb/image"]["header"]["frame_id"] == "thumb"
    assert message["/tactile/thumb/image"]["encoding"] == "32FC1"
    np.testing.assert_array_equal(message["/tactile/thumb/image"]["data"].view("<f4").reshape(4, 4), frame.tactile_image[0])
    assert frame.tactile_image.max() > 0
    np.testing.assert_array_equal(message["/tactile/thumb/taxels"]["data"].view("<f4")[3::4], frame.tactile_image[0].ravel())
    assert message["/tactile/thumb/taxel_counts"]["encoding"] == "32SC3"
    np.testing.assert_array_equal(message["/tactile/thumb/taxel_counts"]["data"].view("<i4").reshape(4, 4, 3), frame.taxel_counts[0])
    np.testing.assert_array_equal(message["/tactile/index/image"]["data"].view("<u2").reshape(6, 14), frames[0].tactile_image[0])


def test_counts_and_newtons_may_alternate(bridge, model, frames, tmp_path):
    simulator = taxelsim.Simulator(model, image_unit="newtons")
    simulator.set_objects(0, [[0, 0, 0.0075, np.sqrt(0.5), np.sqrt(0.5), 0, 0]])
    simulator.step(0.01)
    shown = [frames[0], simulator.read(), frames[1]]
    received = published(bridge, tmp_path / "out", {"/tactile/image": SCHEMAS["image"]}, shown)["messages"]["/tactile/image"]
    for (_, _, message), frame, encoding, dtype in zip(received, shown, ("mono16", "32FC1", "mono16"), ("<u2", "<f4", "<u2"), strict=True):
        assert message["encoding"] == encoding
        np.testing.assert_array_equal(message["data"].view(dtype).reshape(6, 14), frame.tactile_image[0])


def pose_cdr(position=(0.0, 0.0, 0.01), orientation=(0.0, 0.0, 0.0, 1.0), frame_id="sensor"):
    """CDR of a PoseStamped by rosbags. orientation: x, y, z, w."""
    types = STORE.types
    header = types["std_msgs/msg/Header"](stamp=types["builtin_interfaces/msg/Time"](sec=1, nanosec=2), frame_id=frame_id)
    point = types["geometry_msgs/msg/Point"](*position)
    pose = types["geometry_msgs/msg/Pose"](position=point, orientation=types["geometry_msgs/msg/Quaternion"](*orientation))
    return bytes(STORE.serialize_cdr(types[POSE](header=header, pose=pose), POSE))


@contextmanager
def talker(topic="/tactile/cmd_object_pose"):
    """A function that publishes the bytes of a pose."""

    def send(cdr):
        process.stdin.write(cdr.hex() + "\n")
        process.stdin.flush()

    with node("talk", DOMAIN, POSE, topic, stdin=subprocess.PIPE) as process:
        assert process.stdout.readline() == "ready\n"
        yield send


def test_poses_are_taken_and_bad_ones_refused(bridge, caplog):
    nan, inf, half = float("nan"), float("inf"), np.sqrt(0.5)
    bad = {
        "position [nan, 0.0, 0.0] is not allowed: -10 to 10 m": pose_cdr((nan, 0.0, 0.0)),
        "position [0.0, inf, 0.0] is not allowed: -10 to 10 m": pose_cdr((0.0, inf, 0.0)),
        "position [0.0, 0.0, -10.5] is not allowed: -10 to 10 m": pose_cdr((0.0, 0.0, -MAX_DISTANCE - 0.5)),
        "orientation (w, x, y, z) = [0.0, 0.0, 0.0, 0.0] is not allowed: a quaternion of length 1": pose_cdr(
            orientation=(0.0, 0.0, 0.0, 0.0)
        ),
        "orientation (w, x, y, z) = [1.0, 0.1, 0.0, 0.0] is not allowed: a quaternion of length 1": pose_cdr(
            orientation=(0.1, 0.0, 0.0, 1.0)
        ),
        "orientation (w, x, y, z) = [1e+300, 0.0, 0.0, 0.0] is not allowed: a quaternion of length 1": pose_cdr(
            orientation=(0.0, 0.0, 0.0, 1e300)
        ),
        "orientation (w, x, y, z) = [nan, 0.0, 0.0, 0.0] is not allowed: a quaternion of length 1": pose_cdr(
            orientation=(0.0, 0.0, 0.0, nan)
        ),
        "frame_id 'world' is not allowed: 'sensor'": pose_cdr(frame_id="world"),
        "no PoseStamped: UnicodeDecodeError": pose_cdr().replace(b"sensor", b"\xff" * 6),
    }
    with talker() as send:
        wait_until(lambda: send(pose_cdr()) or bridge.take_poses())  # until the reader knows the writer as well
        time.sleep(0.2)
        bridge.take_poses()
        for line, cdr in bad.items():
            caplog.clear()
            send(cdr)
            wait_until(lambda: bridge.take_poses() or caplog.messages)
            (found,) = caplog.messages
            assert found.startswith(f"/tactile/cmd_object_pose: refused: {line}")
        send(pose_cdr((0.001, -0.002, 0.01), (half, 0.0, 0.0, half)))
        np.testing.assert_allclose(wait_until(bridge.take_poses)[""], [0.001, -0.002, 0.01, half, half, 0, 0], rtol=1e-15)
        assert bridge.take_poses() == {}  # each pose once


def test_frames_of_other_sensors_are_refused(bridge, device, frames):
    other = taxelsim.load_sensor(taxelsim.SCENES / "sensors/digitacts_6x4.yaml")
    frame = taxelsim.Simulator(taxelsim.Model(device, other, [taxelsim.Sphere(0.01)])).read().copy()
    with pytest.raises(taxelsim.InputError, match=r"^tactile_image: 72 taxels are not allowed for a sensor of 84$"):
        bridge.publish(frame)
    with pytest.raises(taxelsim.InputError, match=r"^instance: 1 is not allowed: 0 to 0$"):
        bridge.publish(frames[0], instance=1)
    with pytest.raises(taxelsim.InputError, match=r"^frame of sensor 'thumb' is not allowed: ''$"):
        bridge.publish({"thumb": frames[0]})


def test_wrong_arguments_are_one_line_and_leave_the_domain_free(sensor):
    with pytest.raises(taxelsim.InputError, match=r"^domain: 233 is not allowed: 0 to 232$"):
        Bridge(sensor, domain=233)
    with pytest.raises(taxelsim.InputError, match=r"^interface: 'no\\n' is not allowed: .*lo"):
        Bridge(sensor, domain=DOMAIN, interface="no\n")
    for name in ("a/b", "0", "a__b", "a-b", "a" * 300):
        with pytest.raises(taxelsim.InputError, match=r"^sensor '\S+ is not allowed as a part of a topic: up to 200 letters"):
            Bridge({name: sensor}, domain=DOMAIN)
    with Bridge(sensor, domain=DOMAIN), pytest.raises(taxelsim.IoError, match=f"^DDS on interface lo, domain {DOMAIN}: .*"):
        Bridge(sensor, domain=DOMAIN)
    counts = []
    for _ in range(4):
        Bridge(sensor, domain=DOMAIN).close()
        counts.append(len(os.listdir("/proc/self/fd")))  # noqa: PTH208, the count alone
    assert counts[0] == counts[-1]


def test_sockets_receive_from_loopback_only(bridge):
    """Cyclone DDS listens on all addresses, so that each of its sockets must be bound to the device or to the address of loopback."""
    found = []
    for file in filter(Path.is_socket, Path("/proc/self/fd").iterdir()):
        with socket.socket(fileno=os.dup(int(file.name))) as copy:
            if copy.family == socket.AF_INET and copy.type == socket.SOCK_DGRAM:
                device = copy.getsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, 16).rstrip(b"\0")
                found.append((copy.getsockname()[0], device))
    assert set(found) == {("0.0.0.0", b"lo"), ("127.0.0.1", b"")}


def test_the_command_publishes_and_poses_move_the_object(command, tmp_path):
    names = [SCHEMAS["contact_wrench"], "/tactile/contact_wrench"]
    with subprocess.Popen(
        [*command, "--rate", "50", "--allow-input"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        try:
            assert process.stdout.readline() == f"publishes 50 frames/s on lo, domain {DOMAIN}; Ctrl-C ends\n"
            force = {}
            for when in ("before", "after"):
                with node("echo", DOMAIN, tmp_path / when, 5, *names) as echo:
                    assert echo.wait(PATIENCE) == 0
                messages = pickle.loads((tmp_path / when).read_bytes())["messages"]["/tactile/contact_wrench"]
                force[when] = messages[-1][2]["wrench"]["force"]["z"]
                with talker() as send:
                    for _ in range(20):
                        send(pose_cdr((0.0, 0.0, float("nan"))))
                        send(pose_cdr((0.0, 0.0, 5.0)))
                        time.sleep(0.05)
            assert force["before"] == pytest.approx(-2, abs=LOAD_TOLERANCE)
            assert force["after"] == 0
        finally:
            process.send_signal(signal.SIGTERM)
            _, errors = process.communicate(timeout=PATIENCE)
        assert process.returncode == 128 + signal.SIGTERM
        assert "Traceback" not in errors


def test_the_command_ends_by_itself_and_by_ctrl_c(command):
    environment = {**os.environ, "CYCLONEDDS_URI": "file:///none.xml"}  # which the bridge ignores
    words = [*command, "--for", "0.5", "--rate", "20"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE, env=environment)
    assert done.returncode == 0, done.stderr
    assert "frames were published, " in done.stderr
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True) as process:
        process.stdout.readline()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=PATIENCE)
    assert (process.returncode, errors) == (130, "")


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["--domain", "233"], "domain: 233 is not allowed: 0 to 232"),
        (["--interface", "none"], "interface: 'none' is not allowed: "),
        (["--rate", "0"], "--rate: 0.0 is not allowed: 0.01 to 1e+06 Hz"),
        (["--for", "nan"], "--for: nan is not allowed: a finite number above 0"),
        (["--object", "99"], "object 99 of instance 0 is not allowed: 0 to 0, or -1 for none"),
    ],
)
def test_wrong_options_are_one_line(command, arguments, line, capfd):
    assert ros2.main([*command[3:], *arguments]) == 2
    out, errors = capfd.readouterr()
    assert errors.startswith(f"taxelsim ros2: {line}")
    assert (out, errors.count("\n")) == ("", 1)


def test_only_scenes_of_kind_servo_touch_by_themselves(capfd):
    assert ros2.main([str(taxelsim.SCENES / "gripper_grasp.yaml")]) == 2
    assert "without --allow-input nothing touches the sensors" in capfd.readouterr().err
