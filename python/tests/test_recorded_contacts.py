"""Scenes of kind contact_points: recorded contacts of an engine as the source of a data set."""

import hashlib
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import taxelsim
from taxelsim.dataset import Dataset
from taxelsim.export import export
from taxelsim.program import PROGRAM
from taxelsim.report import summarize
from taxelsim.viewer.scene_files import scene_of

SHIPPED = taxelsim.SCENES / "recorded_contacts.yaml"
SENSOR = taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml"
SCENE = f"""format_version: 1
name: recorded
kind: contact_points
sensor: {SENSOR}
contact_points: {{file: contacts.csv}}
episode: {{num_steps: 4, simulation_rate: 100}}
record: [tactile_image, features, ground_truth, tactile_normal_force, contact_features]
data_set: {{episodes_per_shard: 2}}
"""
HEADING = "episode,step,x_m,y_m,z_m,normal_force_N"
VECTORS = "episode,step,x_m,y_m,z_m,fx_N,fy_N,fz_N"
# Step after step of all episodes, as a batched engine writes them. Episode 1 has no contact, step 2 of episode 2 has none, and one point
# lies outside the array.
POINTS = [
    *((0, step, 0.002, 0.004 * step - 0.006, -1e-5, 1.0 + step) for step in range(4)),
    (2, 0, -0.003, 0.01, 0, 0.75),
    (2, 0, -0.003, -0.01, 0, 0.5),
    (2, 1, 0.5, 0, 0, 2),
    (2, 3, 0, 0, 0, 0.25),
    (4, 3, 0, 0, 0, 0.25),
]
NUM_EPISODES, NUM_STEPS = 5, 4
SUM_ERROR = 84 * 2**-24  # relative: 84 taxels, each rounded to float32


def written(folder: Path, lines: list[str] | None = None, scene: str = SCENE) -> Path:
    rows = [",".join(map(repr, point)) for point in sorted(POINTS, key=lambda point: point[1])]
    (folder / "contacts.csv").write_text("\n".join(lines if lines is not None else [HEADING, *rows]) + "\n")
    file = folder / "scene.yaml"
    file.write_text(scene)
    return file


def files_of(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in folder.iterdir() if not file.name.startswith(".")}


def program(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)


def simulated(device: taxelsim.Device, episode: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Image and true normal forces of each step, by Simulator.set_contacts() alone."""
    simulator = taxelsim.Simulator(taxelsim.Model(device, taxelsim.load_sensor(SENSOR)), 1, max_contacts=4)
    frames = []
    for step in range(NUM_STEPS):
        points = np.array([point[2:] for point in POINTS if point[:2] == (episode, step)]).reshape(-1, 4)
        simulator.set_contacts(points[:, :3], points[:, 3], [0, len(points)])
        simulator.step(0.01)
        frame = simulator.read()
        frames.append((frame.tactile_image[0].copy(), frame.ground_truth.tactile_normal_force[0].copy()))
    return frames


def test_frames_are_those_of_set_contacts(device: taxelsim.Device, tmp_path: Path) -> None:
    file = written(tmp_path)
    scene = taxelsim.load_scene(file)
    assert (scene.kind, scene.num_episodes, len(scene.objects)) == (taxelsim.Scene.Kind.CONTACT_POINTS, NUM_EPISODES, 0)
    assert taxelsim.generate(scene, tmp_path / "out", device=device).complete
    data = Dataset(tmp_path / "out")
    for episode in range(NUM_EPISODES):
        for step, (image, forces) in enumerate(simulated(device, episode)):
            frame = episode * NUM_STEPS + step
            np.testing.assert_array_equal(data["data/tactile_image"][frame], image)
            np.testing.assert_array_equal(data["data/ground_truth/tactile_normal_force"][frame], forces)
    np.testing.assert_allclose(data["data/ground_truth/total_force"][:4], [1, 2, 3, 4], rtol=SUM_ERROR)
    assert not data["data/ground_truth/total_force"][4:8].any()
    assert (data["data/ground_truth/off_array_load"][9], data["data/ground_truth/off_array_contacts"][9]) == (2, 1)
    assert data["data/contact/num_regions"][8:12].tolist() == [2, 0, 0, 1]
    digest = hashlib.sha256((tmp_path / "contacts.csv").read_bytes()).hexdigest()
    assert set(data["meta/contact_points"][:]) == {"contacts.csv"}
    assert set(data["meta/contact_points_sha256"][:]) == {digest}


def test_force_vectors_in_the_world_are_those_of_contact_points(device: taxelsim.Device, tmp_path: Path) -> None:
    """The sensor's z is x of the world. The third point pulls."""
    half = 0.5**0.5
    X_WS = [1, 2, 3, half, 0, half, 0]
    positions = np.array([[1, 2.01, 2.995], [1, 1.99, 3.002], [1, 2, 3]])
    forces = np.array([[-2, 5, 5], [-0.5, 0, 1], [3, 0, 0]])
    rows = [",".join(map(repr, (0, 0, *p.tolist(), *f.tolist()))) for p, f in zip(positions, forces, strict=True)]
    pose = f"{{position: {X_WS[:3]}, rotation: {X_WS[3:]}}}"
    text = SCENE.replace("file: contacts.csv", f"file: contacts.csv, frame: world, sensor_pose: {pose}")
    taxelsim.generate(written(tmp_path, [VECTORS, *rows], text), tmp_path / "out", device=device)
    simulator = taxelsim.Simulator(taxelsim.Model(device, taxelsim.load_sensor(SENSOR)), 1, max_contacts=4)
    simulator.set_contacts(*taxelsim.contact_points([0, 0, 0], positions, forces, [X_WS]))
    simulator.step(0.01)
    truth = simulator.read().ground_truth
    assert truth.total_force[0] == pytest.approx(2.5, rel=SUM_ERROR)
    np.testing.assert_allclose(
        Dataset(tmp_path / "out")["data/ground_truth/tactile_normal_force"][0],
        truth.tactile_normal_force[0],
        atol=1e-6,  # N: transforms in double, rounded to float32
    )


POSES = "episode,step,x_m,y_m,z_m,qw,qx,qy,qz"
MOVING = "contacts.csv, frame: world, sensor_poses: {file: poses.csv}}"


def test_a_sensor_that_moves_sees_points_in_its_frame(device: taxelsim.Device, tmp_path: Path) -> None:
    """A pose holds until the next one of the episode. Lines of both files are in any order."""
    half = 0.5**0.5
    X_WS = np.array([[1, 2, 3, half, 0, half, 0], [0, 0, 0.1, half, 0, 0, half], [0, 0, 0.1, 1, 0, 0, 0]])  # z of S: x, z, z of W
    in_pose = {0: 0, 1: 0, 2: 1, 3: 1}  # of episode 0; episode 1 has pose 2
    points = {(0, step): X_WS[pose, :3] + (0.0, 0.004, 0.0) for step, pose in in_pose.items()} | {(1, 3): X_WS[2, :3] + (0.0, -0.01, 0.0)}
    rows = [",".join(map(repr, (*frame, *place.tolist(), 2.0))) for frame, place in reversed(points.items())]
    poses = [(0, 2, 1), (1, 0, 2), (0, 0, 0)]
    (tmp_path / "poses.csv").write_text("\n".join([POSES, *(",".join(map(repr, (e, s, *X_WS[k].tolist()))) for e, s, k in poses)]) + "\n")
    scene = taxelsim.load_scene(written(tmp_path, [HEADING, *rows], SCENE.replace("contacts.csv}", MOVING)))
    assert taxelsim.load_scene(resolved(tmp_path, scene)).resolved == scene.resolved
    taxelsim.generate(scene, tmp_path / "out", device=device)
    data = Dataset(tmp_path / "out")
    simulator = taxelsim.Simulator(taxelsim.Model(device, taxelsim.load_sensor(SENSOR)), 1, max_contacts=4)
    for (episode, step), place in points.items():
        pose = X_WS[2] if episode else X_WS[in_pose[step]]
        push = -2 * np.array([1, 0, 0]) if pose is X_WS[0] or np.array_equal(pose, X_WS[0]) else np.array([0, 0, -2])
        simulator.set_contacts(*taxelsim.contact_points([0], [place], [push], [pose]))
        simulator.step(0.01)
        expected = simulator.read().ground_truth.tactile_normal_force[0]
        assert expected.sum() == pytest.approx(2, rel=SUM_ERROR)
        found = data["data/ground_truth/tactile_normal_force"][episode * NUM_STEPS + step]
        np.testing.assert_allclose(found, expected, atol=1e-6)  # N: transforms in double, rounded to float32
    lost = scene.resolved.replace("poses.csv", "other.csv").replace("contacts.csv", "others.csv")
    assert scene_of(lost, [], tmp_path)[0].num_episodes == 2


def resolved(folder: Path, scene: taxelsim.Scene) -> Path:
    """The resolved scene as a file next to the files that it names."""
    file = folder / "resolved.yaml"
    file.write_text(scene.resolved)
    return file


def test_bytes_depend_on_neither_batch_nor_processes_nor_interruption(tmp_path: Path) -> None:
    scene = written(tmp_path)
    assert program("generate", scene, "-o", tmp_path / "1", "--batch-size", 1).returncode == 0
    expected = files_of(tmp_path / "1")
    assert len([name for name in expected if name.startswith("shard-") and name.endswith(".h5")]) == 3
    for name, arguments in {"3": ["--batch-size", 3], "64": ["--batch-size", 64], "processes": ["--processes", 2]}.items():
        done = program("generate", scene, "-o", tmp_path / name, *arguments)
        assert done.returncode == 0, done.stderr
        assert files_of(tmp_path / name) == expected, name
    assert program("generate", scene, "-o", tmp_path / "part", "--shards", "1..1").returncode == 0
    assert "shard-000000.h5" not in files_of(tmp_path / "part")
    again = program("generate", scene, "-o", tmp_path / "part")
    assert "(2 found on disk)" in again.stdout
    assert files_of(tmp_path / "part") == expected


def replaced(old: str, new: str) -> Callable[[str], str]:
    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new)

    return change


POINT = "0,0,0,0,0,1"


@pytest.mark.parametrize(
    ("lines", "change", "message"),
    [
        ([HEADING.replace(",z_m", ""), "0,0,0,0,1"], str, "contacts.csv:1:1: missing heading: the first line must be episode,step,"),
        ([HEADING, "0,0,0,0,1"], str, "contacts.csv:2:10: missing value of normal_force_N"),
        ([HEADING, POINT, "0,0,0,nan,0,1"], str, 'contacts.csv:3:7: y_m: "nan" is not allowed: a number from -1e+06 to 1e+06 m'),
        ([HEADING, POINT, "0,0,0,0,0,-1"], str, 'normal_force_N: "-1" is not allowed: a number from 0 to 1e+06 N'),
        ([HEADING, "0,4,0,0,0,1"], str, 'contacts.csv:2:3: step: "4" is not allowed: a number from 0 to 3'),
        ([HEADING, "0.5,0,0,0,0,1"], str, "contacts.csv:2:1: episode: 0.5 is not allowed: a whole number from 0 to 999999"),
        (
            [HEADING, POINT, "3,0,0,0,0,1"],
            replaced("contacts.csv}", "contacts.csv, num_episodes: 3}"),
            'contacts.csv:3:1: episode: "3" is not allowed: a number from 0 to 2',
        ),
        ([HEADING] + [POINT] * 4097, str, "contacts.csv:4098:1: more than 4096 contact points in step 0 of episode 0"),
        ([HEADING], str, "contacts.csv:2:1: no contact point found"),
        (None, replaced("contacts.csv}", "contacts.csv, frame: earth}"), "contact_points.frame: earth is not allowed: sensor | world"),
        (None, replaced("contacts.csv}", "contacts.csv, frame: world}"), "contact_points: sensor_pose is missing: X_WS"),
        (
            None,
            replaced("contacts.csv}", "contacts.csv, sensor_poses: {file: poses.csv}}"),
            "contact_points.sensor_poses: needs frame: world",
        ),
        (
            None,
            replaced("contacts.csv}", MOVING),
            "contacts.csv:3:1: sensor_poses has no pose of the sensor at or before step 0 of episode 2",
        ),
        (None, replaced("contacts.csv}", MOVING.replace("poses.csv", "twice.csv")), "twice.csv:3:1: step 0 of episode 0 is given twice"),
        (None, replaced("contacts.csv}", MOVING.replace("poses.csv", "long.csv")), "long.csv:2:11: qw,qx,qy,qz: length 0.5 is not allowed"),
        (
            None,
            replaced("contacts.csv}", MOVING.replace("poses.csv", "late.csv")),
            'late.csv:2:3: step: "4" is not allowed: a number from 0 to 3',
        ),
        (None, replaced("contacts.csv}", "contacts.csv, sensor_pose: {}}"), "contact_points.sensor_pose: needs frame: world"),
        (None, replaced("contacts.csv}", "none.csv}"), "none.csv is not there, or not a file"),
        (None, replaced("contact_points: {file: contacts.csv}\n", ""), "contact_points is missing"),
        (None, replaced("_shard: 2", "_shard: 2, episodes: 6"), "data_set.episodes: episodes: 6 is not allowed: 1 to 5, the episodes of"),
        (None, replaced("[tactile_image,", "[penetration_depth,"), "record[0]: contact points do not determine it"),
        (None, replaced("[tactile_image,", "[poses,"), "record[0]: a scene of kind contact_points has no objects and no robot"),
        (None, replaced("record:", "randomization: {load: 1}\nrecord:"), "randomization.load: unknown key"),
        (None, replaced("record:", "objects: [{sphere: {radius_mm: 5}}]\nrecord:"), "objects: unknown key"),
        ([VECTORS, "0,0,0,0,0,0,0,-1"], replaced("wts0614_soft_cover", "fingertip_sphere"), "fx_N,fy_N,fz_N are not allowed for a sensor"),
    ],
)
def test_refused_input(tmp_path: Path, lines: list[str] | None, change: Callable[[str], str], message: str) -> None:
    poses = {"poses": ["0,0"], "twice": ["0,0", "0,0"], "late": ["0,4"]}
    for name, frames in poses.items():
        (tmp_path / f"{name}.csv").write_text("\n".join([POSES, *(f"{frame},0,0,0,1,0,0,0" for frame in frames)]))
    (tmp_path / "long.csv").write_text(f"{POSES}\n0,0,0,0,0,0.5,0,0,0\n")
    done = program("generate", written(tmp_path, lines, change(SCENE)), "-o", tmp_path / "out")
    assert done.returncode == 2
    assert message in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_refuses_episodes_without_a_recording(device: taxelsim.Device, tmp_path: Path) -> None:
    scene = taxelsim.load_scene(written(tmp_path))
    with pytest.raises(taxelsim.InputError, match=r"episodes: 5 is not allowed: 0 to 4, those of contacts\.csv"):
        taxelsim.generate(scene, tmp_path / "out", device=device, episodes=[1, 5])
    with pytest.raises(taxelsim.InputError, match="kind: contact_points found, an environment needs servo"):
        taxelsim.Environment(device, scene)


def test_shipped_scene_and_its_report(device: taxelsim.Device, tmp_path: Path) -> None:
    """The ball presses with its weight, 0.2 kg, while it rolls; MuJoCo's contact needs 0.1 s to settle."""
    taxelsim.generate(SHIPPED, tmp_path / "out", device=device)
    data = Dataset(tmp_path / "out")
    np.testing.assert_allclose(data["data/ground_truth/total_force"][10:50], 0.2 * 9.81, rtol=1e-3)
    centres = data["data/ground_truth/center_of_pressure"][0:50, 1]
    assert (np.diff(centres) > -1e-8).all()  # m, of float32
    assert centres[-1] - centres[0] == pytest.approx(8 * 0.0034, rel=1e-3)  # 28 mm, in taxels of 3.4 mm
    summary = summarize(data)
    assert summary.objects == {}
    assert {example.stratum.split(",")[0] for example in summary.examples} == {"rolling_and_sliding.csv"}
    text = taxelsim.load_scene(SHIPPED).resolved
    lost = text.replace(data["meta/contact_points_sha256"][0], "0" * 64)
    scene, missing = scene_of(lost, [], tmp_path)
    assert (scene.num_episodes, scene.num_steps, missing) == (2, 50, set())


@pytest.mark.parametrize("name", ["lerobot", "zarr", "mcap"])
def test_exports(device: taxelsim.Device, tmp_path: Path, name: str) -> None:
    taxelsim.generate(SHIPPED, tmp_path / "data", device=device)
    exported = export(tmp_path / "data", tmp_path / "out", name)
    assert (exported.num_episodes, exported.num_frames, exported.episode_columns) == (2, 100, ("meta/contact_points",))
    assert any((tmp_path / "out").iterdir())
