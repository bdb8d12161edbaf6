"""Data sets of several sensors in everything that reads data sets: by sensor, in exports, reports and the viewer."""

import json
import pickle
import subprocess
from pathlib import Path

import numpy as np
import pytest
from taxelsim._pictures import EpisodePictures

import taxelsim
from taxelsim.commands.render import main
from taxelsim.dataset.dataset import dataset_of_one_sensor
from taxelsim.export import FORMATS, Options, export
from taxelsim.pictures import tactile_pictures, taxel_chart
from taxelsim.program import PROGRAM
from taxelsim.report import page_of, summarize

SENSORS = ("left", "right", "below")
EPISODES = [2, 0]


@pytest.fixture(scope="module")
def grasped(tmp_path_factory: pytest.TempPathFactory, device: taxelsim.Device) -> Path:
    """Two episodes of a gripper, in another order than in its scene."""
    folder = tmp_path_factory.mktemp("grasped") / "data"
    taxelsim.generate(taxelsim.SCENES / "gripper_grasp.yaml", folder, episodes=EPISODES, device=device)
    return folder


def test_an_episode_is_a_moving_picture_of_one_sensor(grasped: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The picture has sensor and object in 3-D, from the poses that every grasp records."""
    moving = {name: EpisodePictures(str(grasped), 2, sensor=name) for name in ("", *SENSORS)}
    assert [pictures.without_view for pictures in moving.values()] == [""] * 4
    frames = {name: pictures.draw(140) for name, pictures in moving.items()}
    assert np.array_equal(frames[""], frames["left"])
    assert not np.array_equal(frames["left"], frames["right"])
    assert not np.array_equal(frames["left"], moving["left"].draw(0))
    common = [str(grasped), "--episode", "2", "--range", "900"]
    assert main([*common, "-o", str(tmp_path / "below.gif"), "--sensor", "below", "--speed", "4"]) == 0
    assert (tmp_path / "below.gif").read_bytes().startswith(b"GIF89a")
    assert main([*common, "-o", str(tmp_path / "x.gif"), "--sensor", "top"]) == 2
    assert "--sensor top: its sensors are left, right, below" in capsys.readouterr().err
    picture = subprocess.run(
        [PROGRAM, "render", grasped, "-o", tmp_path / "x.webp", "--episode", "2", "--sensor", "below"], capture_output=True, check=True
    )
    assert b"75 frames" in picture.stdout


def test_program_reads_one_sensor(grasped: Path) -> None:
    """inspect leaves out the columns of the others; compare takes the images of one."""

    def run(*words: str) -> str:
        return subprocess.run([PROGRAM, *words], capture_output=True, text=True, check=False).stdout

    columns = [column["name"] for column in json.loads(run("inspect", str(grasped), "--sensor", "left", "--json"))["columns"]]
    assert {name.split("/")[1] for name in columns if name.startswith("data/")} == {"time", "robot", "object_pose", "left"}
    same = json.loads(run("compare", str(grasped), str(grasped), "--sensor", "right", "--json"))
    images = taxelsim.Dataset(grasped)["data/right/tactile_image"][:]
    active = (images.reshape(len(images), -1) > 0).sum(axis=1)
    assert [pair["active_taxels"] for pair in same["pairs"]] == active.tolist()
    assert {pair["M3_rms_difference"] for pair in same["pairs"]} == {0, None}


@pytest.mark.parametrize(("name", "radius"), [("fingertip_sphere", 8e-3), ("fingertip_cylinder", None)])
def test_curved_tips_are_drawn_unrolled(name: str, radius: float | None) -> None:
    """A taxel of a sphere is drawn at its arc length from the apex; one of a grid where it is."""
    tip = taxelsim.load_sensor(taxelsim.SCENES / f"sensors/{name}.yaml")
    positions, axes = taxel_chart(tip)
    assert positions.shape == (tip.num_taxels, 2)
    np.testing.assert_allclose(np.linalg.norm(axes, axis=-1), 1)
    if radius is not None:
        arcs = radius * np.arccos(np.clip(tip.taxel_normals[:, 2], -1, 1))
        np.testing.assert_allclose(np.linalg.norm(positions - positions[0], axis=1), arcs, atol=2e-5)  # positions are given to 1e-9 m
    flat = taxelsim.load_sensor(taxelsim.SCENES / "sensors/fingertip_6x4.yaml")
    np.testing.assert_array_equal(taxel_chart(flat)[0], flat.taxel_positions[:, :2])
    pictures = tactile_pictures(tip, np.eye(tip.num_taxels)[:2] * 100)
    assert (pictures[0] != pictures[1]).any()


def test_episodes_of_a_list_have_the_bytes_of_the_whole_data_set(grasped: Path, tmp_path: Path, device: taxelsim.Device) -> None:
    taxelsim.generate(taxelsim.SCENES / "gripper_grasp.yaml", tmp_path / "first", episodes=range(3), device=device)
    chosen, whole = taxelsim.Dataset(grasped), taxelsim.Dataset(tmp_path / "first")
    np.testing.assert_array_equal(chosen["meta/episode"], EPISODES)
    for row, number in enumerate(EPISODES):
        for name in chosen.columns:
            if name != "meta/episode_ends":
                np.testing.assert_array_equal(chosen.episode(row)[name], whole.episode(number)[name], err_msg=name)


@pytest.mark.parametrize("isolated", [False, True])
def test_a_sensor_looks_like_a_data_set_of_its_own(grasped: Path, isolated: bool) -> None:
    whole = taxelsim.Dataset(grasped, isolated=isolated)
    assert whole.sensors == SENSORS
    one = taxelsim.Dataset(grasped, sensor="right", isolated=isolated)
    own = {name.replace("data/right/", "data/"): name for name in whole.columns if not name.startswith(("data/left/", "data/below/"))}
    assert sorted(one.columns) == sorted(own)
    for name, stored in own.items():
        np.testing.assert_array_equal(one[name][::7], whole[stored][::7], err_msg=name)
        assert one[name].path == stored
    again = pickle.loads(pickle.dumps(one))
    np.testing.assert_array_equal(again["data/total_force"], whole["data/right/total_force"])
    windows = one.windows(4, columns=["data/tactile_image"], image_unit="newtons")
    assert windows[0]["data/tactile_image"].dtype == np.float32
    with pytest.raises(taxelsim.InputError, match="sensor 'thumb': its sensors are left, right, below"):
        taxelsim.Dataset(grasped, sensor="thumb")


def test_a_data_set_of_one_sensor_has_no_names_of_sensors(tmp_path: Path, device: taxelsim.Device) -> None:
    taxelsim.generate(taxelsim.SCENES / "labelled_contacts.yaml", tmp_path / "out", episodes=range(2), device=device)
    assert taxelsim.Dataset(tmp_path / "out").sensors == ()
    with pytest.raises(taxelsim.InputError, match="its columns are not grouped by sensor"):
        taxelsim.Dataset(tmp_path / "out", sensor="left")


def test_exports_have_all_sensors_or_one(grasped: Path, tmp_path: Path) -> None:
    data = taxelsim.Dataset(grasped)
    zarr = pytest.importorskip("zarr")
    export(grasped, tmp_path / "zarr", "zarr")
    group = zarr.open_group(tmp_path / "zarr", mode="r")["data"]
    for name in SENSORS:
        np.testing.assert_array_equal(group[f"tactile_{name}"][:], data[f"data/{name}/tactile_image"])
    export(grasped, tmp_path / "one", "zarr", Options(sensor="right"))
    np.testing.assert_array_equal(zarr.open_group(tmp_path / "one", mode="r")["data/tactile"][:], data["data/right/tactile_image"])
    pytest.importorskip("pyarrow")
    export(grasped, tmp_path / "lerobot", "lerobot")
    info = json.loads((tmp_path / "lerobot/meta/info.json").read_text())
    assert [name for name in info["features"] if "tactile" in name] == [f"observation.tactile.{name}" for name in SENSORS]
    with pytest.raises(taxelsim.InputError, match="video: choose a sensor: left, right, below"):
        export(grasped, tmp_path / "video", "lerobot", Options(video=True))
    read = pytest.importorskip("mcap_ros2.reader").read_ros2_messages
    export(grasped, tmp_path / "mcap", "mcap")
    topics = {message.channel.topic for message in read(str(tmp_path / "mcap/episode-000000.mcap"))}
    assert {f"/tactile/{name}/image" for name in SENSORS} <= topics
    with pytest.raises(taxelsim.InputError, match="data/action, which robomimic needs"):
        export(grasped, tmp_path / "robomimic", "robomimic")
    assert set(FORMATS) == {"zarr", "oxt", "lerobot", "mcap", "robomimic"}


@pytest.mark.parametrize("sensor", [None, "right"])
def test_a_report_shows_one_sensor(grasped: Path, sensor: str | None) -> None:
    summary = summarize(dataset_of_one_sensor(grasped, sensor))
    data, name = taxelsim.Dataset(grasped), sensor or "left"
    assert summary.sensor_name.startswith(f"{name} of left, right, below: ")
    touched = (data[f"data/{name}/tactile_image"][:] > 0).reshape(data.num_frames, -1)
    np.testing.assert_array_equal(summary.taxel_contacts, touched.sum(0))
    assert page_of(summary).count("data:image/png") == 4  # three forces, and where it was touched


def test_the_viewer_has_all_sensors_and_objects(grasped: Path, tmp_path: Path) -> None:
    pytest.importorskip("rerun")
    from .viewer.conftest import Recorded

    (tmp_path / "view.rrd").write_bytes(taxelsim.view(grasped, 2).memory_recording().drain_as_bytes())
    recorded = Recorded(tmp_path / "view.rrd")
    data = taxelsim.Dataset(grasped)
    frames = int(data.episode_ends[0])
    for name in SENSORS:
        translations = np.asarray(recorded[f"episode_2/world/{name}", "Transform3D:translation"]).reshape(-1, 3)
        np.testing.assert_allclose(translations, data[f"data/{name}/sensor_pose"][:frames, :3], rtol=1e-6, atol=1e-9)
        assert recorded[f"episode_2/tactile_image/{name}", "DepthImage:depth_range"] is not None
    objects = np.asarray(recorded["episode_2/world/object_0", "Transform3D:translation"]).reshape(-1, 3)
    np.testing.assert_allclose(objects, data["data/object_pose"][:frames, 0, :3], rtol=1e-6, atol=1e-9)


def robot(file: Path, *options: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([PROGRAM, "robot", file, *options], capture_output=True, text=True, check=False)


def test_a_robot_file_shows_where_its_sensors_are(grasped: Path, tmp_path: Path) -> None:
    file = taxelsim.SCENES / "robots/gripper.yaml"
    shown = json.loads(robot(file, "--json").stdout)
    data = taxelsim.Dataset(grasped)  # whose first frame has the initial posture
    for sensor in shown["sensors"]:
        pose = data[f"data/{sensor['name']}/sensor_pose"][0]
        np.testing.assert_allclose(sensor["X_WS"]["position"] + sensor["X_WS"]["rotation"], pose, atol=1e-9)
    assert [joint["name"] for joint in shown["joints"]] == ["jaw", "bend"]
    moved = json.loads(robot(file, "--json", "--joint", "jaw=10", "--png", str(tmp_path / "robot.png")).stdout)
    distance = np.subtract(*(sensor["X_WS"]["position"] for sensor in moved["sensors"][:2]))
    np.testing.assert_allclose(np.linalg.norm(distance), 0.08 - 0.02, atol=1e-12)  # both jaws close by 10 mm
    assert (tmp_path / "robot.png").stat().st_size > 10000
    assert "right_jaw" in robot(file).stdout


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--joint", "jaw=100"], "--joint: jaw=100 is not allowed: 0 to 35 mm"),
        (["--joint", "thumb=1"], "--joint: thumb=1 is not allowed: NAME=POSITION of one of jaw, bend"),
        (["--joint", "jaw=nan"], "--joint: jaw=nan is not allowed: 0 to 35 mm"),
        (["--png", "robot.jpg"], "robot.jpg"),
    ],
)
def test_a_wrong_option_of_robot_is_one_line(options: list[str], message: str) -> None:
    done = robot(taxelsim.SCENES / "robots/gripper.yaml", *options)
    assert done.returncode == 2
    assert message in done.stderr
    assert done.stderr.count("\n") == 1


def test_program_shows_how_fingers_close() -> None:
    """The gripper by hand: jaws at y = +-(0.04 - q0), q0 to 0.035; a finger of 0.03 and 0.02 m at angles q1 and 1.5 q1 - 0.1."""
    scene = str(taxelsim.SCENES / "gripper_grasp.yaml")
    shown = json.loads(robot(scene, "--json").stdout)
    left, below = shown["fingers"]
    assert (left["name"], below["name"], left["nearest_object"], left["distance"]) == ("left", "below", "box", 0)
    np.testing.assert_allclose([left["X_WS_open"]["position"], left["X_WS_closed"]["position"]], [[0, 0.04, 0], [0, 0.005, 0]], atol=1e-12)
    for q1, pose in ((np.deg2rad(-20), "X_WS_open"), (0.6, "X_WS_closed")):
        tip = 1.5 * q1 - 0.1
        place = [-0.05 + 0.03 * np.cos(q1) + 0.02 * np.cos(tip), 0, -0.02 + 0.03 * np.sin(q1) + 0.02 * np.sin(tip)]
        np.testing.assert_allclose(below[pose]["position"], place, atol=1e-12)
    jaws, *others = shown["pairs"]
    # The jaws close together to 10 mm. Of grids of 2.5 and 3.4 mm, x of the nearest taxels differs by 0.45 mm, y by 0.05.
    assert (jaws["sensors"], jaws["can_touch"]) == (["left", "right"], False)
    x, y = ((np.arange(n) - (n - 1) / 2) * p for n, p in ((6, 2.5e-3), (4, 2.5e-3)))
    u, v = ((np.arange(n) - (n - 1) / 2) * p for n, p in ((6, 3.4e-3), (14, 3.4e-3)))
    gap = np.hypot(np.abs(np.subtract.outer(x, u)).min(), np.abs(np.subtract.outer(y, v)).min())
    assert jaws["distance"] == pytest.approx(np.hypot(0.01, gap), rel=1e-9)
    assert [pair["can_touch"] for pair in others] == [True, True]  # the finger reaches where the jaws are when they stay open or close
    closed = json.loads(robot(scene, "--json", "--closed").stdout)
    assert [joint["position"] for joint in closed["joints"]] == pytest.approx([0.035, 0.6], rel=1e-6)
    assert "--closed" in robot(str(taxelsim.SCENES / "robots/gripper.yaml"), "--closed").stderr
