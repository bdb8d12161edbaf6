"""What a new user meets first: one test per trap that somebody fell into, each in the words of that user."""

import hashlib
import inspect
import itertools
import json
import logging
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import av
import gymnasium
import h5py
import mujoco
import numpy as np
import pytest
from taxelsim._pictures import EpisodePictures

import taxelsim
import taxelsim.envs
import taxelsim.mujoco
from taxelsim.envs import TactileEnv, TactileVectorEnv
from taxelsim.export import FORMATS, Options, export
from taxelsim.pictures import TAXEL_COUNTS, range_of, tactile_pictures
from taxelsim.policies import OnnxPolicy
from taxelsim.program import PROGRAM
from taxelsim.report import summarize
from taxelsim.vectorized import VectorEnvArguments

from .envs.conftest import write_scene
from .mujoco import models
from .viewer.conftest import Recorded

ROOT = Path(__file__).resolve().parents[2]

# == Every shape pushes back wherever areas are sampled ==


def test_a_plane_over_the_default_sensor_presses_where_it_touches_only(device):
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614.yaml")
    simulator = taxelsim.Simulator(taxelsim.Model(device, sensor, [taxelsim.HalfSpace()]), 2)
    floor_behind = [0, 0, -0.03, 0, 1, 0, 0]
    simulator.set_objects(0, np.array([[0, 0, 0.03, 1, 0, 0, 0], floor_behind]))
    simulator.step(0.001)
    assert simulator.read().ground_truth.total_force.tolist() == [0, 0]
    simulator.set_loads(5)
    simulator.step(0.001)
    truth = simulator.read().ground_truth
    assert truth.load_reached.tolist() == [True, False]
    assert truth.total_force[0] == pytest.approx(5, abs=1e-4)


# == Gymnasium's own vector environments take every task ==

GYMNASIUM_TASKS = (
    "EdgeFollow",
    "SurfaceFollow",
    "EdgeAlign",
    "RollTrack",
    "ContourLap",
    "TouchClassify",
    "Push",
    "Roll",
    "GraspHold",
    "PegInsert",
)


@pytest.mark.filterwarnings("ignore:.*A Box observation space:UserWarning")
@pytest.mark.parametrize("task", GYMNASIUM_TASKS)
def test_every_task_in_a_sync_vector_environment(device, task):
    seeds = [1, 2**64 - 1]
    envs = gymnasium.make_vec(f"taxelsim/{task}-v0", num_envs=2, vectorization_mode="sync", device=device)
    observations, infos = envs.reset(seed=seeds)
    expected = taxelsim.episode_keys(seeds, 0, 0)
    assert infos["episode_key"].dtype == np.uint64
    assert infos["episode_key"].tolist() == expected.tolist()
    assert envs.observation_space.contains(observations)
    *_, infos = envs.step(np.zeros(envs.action_space.shape, np.float32))
    assert infos["episode_key"].tolist() == expected.tolist()
    envs.close()


WORKERS = """
import gymnasium, numpy as np

if __name__ == "__main__":
    # Gymnasium imports the module that the id names.
    def play(**arguments):
        envs = gymnasium.make_vec("taxelsim.envs:taxelsim/EdgeAlign-v0", num_envs=2, **arguments)
        observations, infos = envs.reset(seed=1)
        observations, rewards, *_ = envs.step(np.full((2, 4), 0.1, np.float32))
        envs.close()
        return observations.tobytes(), rewards.tobytes(), infos["episode_key"].tobytes(), infos["episode_key"].dtype

    expected = play(vectorization_mode="sync")
    for context in ("fork", "spawn"):
        assert play(vectorization_mode="async", vector_kwargs={"context": context}) == expected, context
"""


def test_workers_that_are_forked_and_spawned(tmp_path):
    script = tmp_path / "workers.py"
    script.write_text(WORKERS)
    done = subprocess.run([sys.executable, "-W", "ignore", script], capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr


def test_the_entry_point_registers_every_task_and_imports_none():
    text = (Path(__file__).resolve().parents[2] / "pyproject.toml").read_text()
    found = re.search(r'\[project.entry-points."gymnasium.envs"\]\ntaxelsim = "(.*)"', text)
    command = f"""
import sys, gymnasium
from importlib.metadata import EntryPoint
EntryPoint("taxelsim", {found[1]!r}, "gymnasium.envs").load()()
tasks = {{id: spec for id, spec in gymnasium.registry.items() if spec.namespace == "taxelsim"}}
assert sorted(tasks) == sorted(f"taxelsim/{{task}}-v0" for task in {GYMNASIUM_TASKS!r}), tasks
assert all(spec.entry_point and spec.vector_entry_point for spec in tasks.values())
assert "taxelsim.envs" not in sys.modules
"""
    done = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr


# == Counts are integers that torch computes with ==


def pressed(simulator: taxelsim.Simulator, height: float) -> taxelsim.Frame:
    simulator.set_objects(1, [[0, 0, height - 1e-4 * i, 1, 0, 0, 0] for i in range(simulator.num_instances)])
    simulator.step(0.001)
    return simulator.read()


def test_counts_are_signed_and_share_the_memory(simulator):
    frame = pressed(simulator, 0.0099)
    image = frame.tactile_image
    assert image.dtype == np.int32
    assert image.max() > 0
    assert (image - image.max()).min() == -image.max()
    assert np.shares_memory(image, simulator._batch.arrays()["tactile_image"])
    before = image.max()
    pressed(simulator, 0.0095)
    assert image.max() > before
    assert (np.from_dlpack(image) - image.max()).min() < 0


def test_newtons_on_request(model, device):
    counts, newtons = taxelsim.Simulator(model, 2), taxelsim.Simulator(model, 2, image_unit="newtons")
    images = [pressed(simulator, 0.0095).tactile_image for simulator in (counts, newtons)]
    readout = model.sensor.readout
    assert images[1].dtype == np.float32
    assert not images[1].flags.writeable
    np.testing.assert_array_equal(images[1], np.vectorize(lambda c: taxelsim.nominal_force(readout, c), otypes=[np.float32])(images[0]))
    assert pressed(newtons, 0.009).tactile_image is images[1]
    assert images[1].sum(axis=(1, 2)) == pytest.approx(newtons.read().total_force, rel=1e-5)
    with pytest.raises(taxelsim.InputError, match=r"^image_unit: 'N' is not allowed: counts, newtons$"):
        taxelsim.Simulator(model, 1, image_unit="N")


def test_environments_and_windows_have_the_same_counts_and_newtons(device, tmp_path):
    scene = taxelsim.load_scene(write_scene(tmp_path, record="tactile_image"), num_episodes=2)
    taxelsim.generate(scene, tmp_path / "data", device=device)
    data = taxelsim.Dataset(tmp_path / "data")
    names = ["data/tactile_image", "meta/object"]
    counts, newtons = (data.windows(1, columns=names, image_unit=unit)[0] for unit in ("counts", "newtons"))
    frames = []
    for unit in ("counts", "newtons"):
        environment = taxelsim.Environment(device, scene, image_unit=unit)
        environment.reset([True], [0])
        frames.append(environment.observe().tactile_image)
    for window, image, dtype in zip((counts, newtons), frames, (np.int32, np.float32), strict=True):
        assert (window["data/tactile_image"].dtype, image.dtype, window["meta/object"].dtype) == (dtype, dtype, np.int32)
        np.testing.assert_array_equal(window["data/tactile_image"], image)
        assert image.any()
    assert data["data/tactile_image"].dtype == data["data/tactile_image"][:].dtype == np.uint16  # as stored


# == A policy gets every output that it asks for ==

OUTPUTS = {
    "tactile_normal_force": ("ground_truth", "tactile_normal_force"),
    "tactile_shear_force": ("ground_truth", "tactile_shear_force"),
    "penetration_depth": ("ground_truth", "penetration_depth"),
    "taxel_counts": ("taxel_counts",),
    "contact_features": ("contact",),
    "clean_contact_features": ("ground_truth", "contact"),
    "tactile_jacobian": ("jacobian",),
    "clean_tactile_jacobian": ("ground_truth", "jacobian"),
    "taxel_jacobian": ("ground_truth", "taxel_jacobian"),
}


def test_a_policy_gets_every_output_that_it_asks_for_and_no_other(device, tmp_path):
    (tmp_path / "scene.yaml").write_text(f"""
format_version: 1
name: short
sensor: {taxelsim.SCENES / "sensors/uskin_like_4x4.yaml"}
kind: servo
objects: [sphere: {{radius_mm: 10}}]
episode: {{num_steps: 1, simulation_rate: 100}}
randomization: {{load: 1}}
controller: {{tactile_servo: {{total_force: {{kp: 1}}}}}}
task: {{total_force: {{tolerance: 1}}}}
data_set: {{episodes: 1}}
""")
    scene = taxelsim.load_scene(tmp_path / "scene.yaml")
    assert {*OUTPUTS, "vjp"} == set(taxelsim.OutputOptions._fields)  # nothing of vjp is in a frame
    for is_asked in (True, False):
        outputs = taxelsim.OutputOptions(**{name: is_asked and name in OUTPUTS for name in taxelsim.OutputOptions._fields})
        found: list[str] = []

        def act(arrays, instances, _, found=found):
            for name, path in OUTPUTS.items():
                values = arrays["frame"]
                for key in path:
                    values = values.get(key, {})
                found.extend([name] if len(values) > 0 else [])
            return np.zeros((len(instances), 6))

        taxelsim._core.evaluate(device, scene, [], 1, 1, None, ("policy", "", False, outputs, act), [])
        assert found == (list(OUTPUTS) if is_asked else [])


# == Pictures are bright wherever something touches ==

USKIN = taxelsim.SCENES / "sensors/uskin_like_4x4.yaml"


@pytest.fixture(scope="module")
def pressed_scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The shipped three-axis sensor under 3 N, two episodes."""
    file = write_scene(tmp_path_factory.mktemp("pressed"), record="tactile_image, taxel_counts, poses, actions")
    plain = str((taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").resolve())
    text = file.read_text().replace(plain, str(USKIN.resolve())).replace("noise: [0, 20]", "noise: 0")
    file.write_text(text.replace("load: [1, 3]", "load: 3").replace("episodes: 24", "episodes: 2"))
    return file


@pytest.fixture(scope="module")
def pressed_set(pressed_scene: Path, device: taxelsim.Device) -> taxelsim.Dataset:
    taxelsim.generate(pressed_scene, pressed_scene.parent / "data", device=device)
    return taxelsim.Dataset(pressed_scene.parent / "data")


def test_the_video_of_a_light_press_is_bright_and_shows_shear(pressed_set: taxelsim.Dataset, tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    export(pressed_set.folder, tmp_path / "out", "lerobot", Options(video=True))
    with av.open(tmp_path / "out/videos/observation.images.tactile/chunk-000/file-000.mp4") as film:
        pictures = [frame.to_ndarray(format="rgb24").astype(int) for frame in film.decode(video=0)]
    assert 150 < min(picture.max() for picture in pictures) < 230 < max(picture.max() for picture in pictures)
    info, about = (json.loads((tmp_path / f"out/meta/{name}.json").read_text()) for name in ("info", "taxelsim"))
    assert info["features"]["observation.taxel_counts"]["names"][:3] == ["r0_c0_x", "r0_c0_y", "r0_c0_normal"]
    assert about["video"] == {"column": TAXEL_COUNTS, "range": range_of(pressed_set, TAXEL_COUNTS)}
    counts, sensor = pressed_set[TAXEL_COUNTS][:], taxelsim.load_sensor(USKIN)
    with_arrows, without = (tactile_pictures(sensor, shown, about["video"]["range"]) for shown in (counts, counts[..., 2]))
    is_arrow = (with_arrows != without).any(-1)
    assert is_arrow[-1].sum() > 50  # pixels
    errors = [np.abs(np.array(pictures) - drawn)[is_arrow].mean() for drawn in (with_arrows, without)]
    assert errors[0] < 0.5 * errors[1]


def test_every_export_has_the_counts_of_three_axis_taxels(pressed_set: taxelsim.Dataset, tmp_path: Path) -> None:
    counts = pressed_set[TAXEL_COUNTS][:]
    for name in ("zarr", "robomimic", "mcap"):
        pytest.importorskip(FORMATS[name].packages[0])
        export(pressed_set.folder, tmp_path / name, name)
    zarr, read = pytest.importorskip("zarr"), pytest.importorskip("mcap_ros2.reader").read_ros2_messages
    flat = zarr.open_group(tmp_path / "zarr", mode="r")["data/taxel_counts"]
    np.testing.assert_array_equal(flat[:], counts.reshape(len(counts), -1))
    with h5py.File(tmp_path / "robomimic") as file:
        np.testing.assert_array_equal(file["data/demo_1/obs/taxel_counts"][:], flat[13:])
    messages = list(read(str(tmp_path / "mcap/episode-000001.mcap"), topics=["/tactile/taxel_counts"]))
    image = messages[0].ros_msg
    assert (image.height, image.width, image.step, image.encoding) == (4, 4, 48, "32SC3")
    np.testing.assert_array_equal(np.frombuffer(image.data, "<i4").reshape(4, 4, 3), counts[13])


def test_all_pictures_of_a_data_set_have_one_scale(pressed_set: taxelsim.Dataset, tmp_path: Path) -> None:
    normal = pressed_set[TAXEL_COUNTS][:][..., 2]
    expected = range_of(pressed_set, TAXEL_COUNTS)
    assert expected == np.quantile(normal[normal > 30], 0.999, method="inverted_cdf")  # 30: ten standard deviations of the noise

    pictures = [EpisodePictures(str(pressed_set.folder), 1, counts).draw(0) for counts in (0, expected, 2 * expected)]
    assert (pictures[0] == pictures[1]).all()
    assert (pictures[0] != pictures[2]).any()
    files = [tmp_path / name for name in ("default.png", "same.png", "other.png")]
    for file, options in zip(files, ([], ["--range", expected], ["--range", 2 * expected]), strict=True):
        subprocess.run([PROGRAM, "render", pressed_set.folder, "-o", file, *map(str, options)], check=True, capture_output=True)
    contents = [file.read_bytes() for file in files]
    assert contents[0] == contents[1] != contents[2]
    assert [summarize(pressed_set, range=given).range for given in (None, 5)] == [expected, 5]
    for given in (None, 5):
        (tmp_path / "view.rrd").write_bytes(taxelsim.view(pressed_set.folder, 0, range=given).memory_recording().drain_as_bytes())
        limits = Recorded(tmp_path / "view.rrd")["episode_0/taxel_counts/normal", "DepthImage:depth_range"].ravel()
        assert list(limits) == [0, given or expected]
    for options, message in (
        ({"range": 1}, "range: needs video"),
        ({"video": True, "range": 0}, "range: 0 is not allowed: a finite number above 0"),
    ):
        with pytest.raises(taxelsim.InputError, match=message):
            export(pressed_set.folder, tmp_path / "refused", "lerobot", Options(**options))


def test_pictures_of_an_environment_are_bright_and_do_not_flicker(pressed_scene: Path, device: taxelsim.Device) -> None:
    counts, pictures = [], []
    env = TactileEnv(
        pressed_scene, render_mode="rgb_array", observations="taxel_counts", actions=("v_x", "v_z"), linear_scale=0.02, device=device
    )
    counts.append(env.reset(seed=0)[0])
    for step in range(6):  # presses, then lifts
        pictures.append(env.render())
        counts.append(env.step(np.array([1, 1 if step < 3 else -1], np.float32))[0])
    assert min(picture.max() for picture in pictures) > 150
    largest = np.maximum.accumulate([shown[..., 2].max() for shown in counts])
    assert largest[0] < largest[3] == largest[5]
    sensor = taxelsim.load_sensor(USKIN)
    for shown, picture, scale in zip(counts, pictures, largest, strict=False):
        np.testing.assert_array_equal(picture, tactile_pictures(sensor, shown[None], float(scale))[0])
    fixed = TactileEnv(pressed_scene, render_mode="rgb_array", range=2e5, device=device)
    fixed.reset(seed=0)
    assert fixed.render().max() < 70  # the counts are a hundredth of this range


def test_noise_is_no_bright_picture() -> None:
    sensor = taxelsim.load_sensor(USKIN)
    noise = np.random.default_rng(0).normal(0, 3, (100, 16, 3)).round()
    pictures = tactile_pictures(sensor, noise)
    assert pictures[..., 0].max() < 60  # neither yellow nor red
    assert pictures.max() < 160


# == Cross-validation compares what can be compared ==


def test_cross_validation_of_the_shipped_measurements_says_what_it_cannot_compare(tmp_path: Path) -> None:
    files = sorted((ROOT / "scenes/measurements").glob("*.yaml"))
    command = [PROGRAM, "characterize", *files, "-o", tmp_path / "sensor.yaml", "--cross-validate"]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=True)
    stamps, cycles, *_ = done.stdout.splitlines()
    assert stamps.startswith("left-out loads: this set cannot be cross-validated by stamps: no two loads were pressed at one place")
    assert cycles.startswith("left-out cycles or halves: the fitted sensor predicts better than every baseline")
    assert done.stdout.count("M4, %") == 2  # the tables of the force curves: the medians, and each measurement


# == evaluate() takes the name of one controller ==


def test_one_name_is_one_controller(device, tmp_path):
    scene = taxelsim.load_scene(write_scene(tmp_path), num_episodes=2)
    one, several = (taxelsim.evaluate(scene, names, device=device) for names in ("servo", ["servo"]))
    assert [evaluation.controller for evaluation in one] == ["servo"]
    assert one[0].verdicts["travel"].tobytes() == several[0].verdicts["travel"].tobytes()
    parts = [taxelsim.evaluate_part(scene, "servo", episodes=range(k, k + 1), device=device) for k in range(2)]
    assert [evaluation.controller for evaluation in taxelsim.merge_evaluations(scene, parts, "servo")] == ["servo"]
    with pytest.raises(taxelsim.InputError, match=r"short\.yaml: controller window: not in this scene; it has servo$"):
        taxelsim.evaluate(scene, "window", device=device)


# == observe() refuses the data of another model ==


@pytest.mark.parametrize(
    ("geom", "pad", "field"),
    [
        ('<geom name="ball" size=".012"/>', "", "geom_size"),
        ('<geom name="ball" type="box" size=".01 .01 .01"/>', "", "geom_type"),
        ('<geom name="ball" size=".01" pos="0 0 .001"/>', "", "geom_pos"),
        ('<geom name="ball" size=".01"/>', '<site pos="0 0 .01"/>', "nsite"),
    ],
)
def test_data_of_another_model_of_the_same_size(device, geom, pad, field):
    tactile = taxelsim.mujoco.attach(models.scene(), {"palm": models.WTS}, ["ball"], device=device)
    other = models.scene(geom, pad)
    for source in (mujoco.MjData(other), mujoco.batch.Batch(other, 1)):
        with pytest.raises(taxelsim.InputError, match=rf"^{type(source).__name__} of another model: {field} "):
            tactile.observe(source)


def test_copies_of_a_model_may_have_other_masses_unless_the_skin_pushes(device):
    model, heavy = models.scene(), models.scene('<geom name="ball" size=".01" mass="3"/>')
    sensors, geoms = {"palm": models.WTS}, ["ball"]
    tactile = taxelsim.mujoco.attach(model, sensors, geoms, num_instances=2, device=device)
    data = mujoco.MjData(model)
    models.place(model, data, (0, 0, 0.0095, 1, 0, 0, 0))
    twin = mujoco.MjData(heavy)
    twin.qpos[:] = data.qpos
    forces = tactile.observe([data, twin])["palm"].total_force
    assert forces[0] == forces[1] > 0
    free = [f'<geom name="ball" size=".01" contype="0" conaffinity="0" mass="{mass}"/>' for mass in (1, 3)]
    coupling = taxelsim.mujoco.couple(models.scene(free[0]), sensors, geoms, device=device)
    with pytest.raises(taxelsim.InputError, match=r"^MjData of another model: body_mass differs from that of the attached model$"):
        coupling.step(mujoco.MjData(models.scene(free[1])))


# == The benchmark page shows a policy that was trained to its end ==


def test_ppo_of_the_page_is_trained_as_long_as_the_example() -> None:
    found = json.loads((ROOT / "bench/results/learn-EdgeFollow.json").read_text())
    steps = found["recipe"]["num_steps"]
    assert f'"{steps}"' in (ROOT / "examples/train_ppo.py").read_text(), "the default of NUM_STEPS"
    assert f"num_steps: int = {steps:_}\n" in (ROOT / "bench/python/learn/recipe.py").read_text(), "the default of the program"
    assert found["curves"]["ppo"]["points"][-1]["steps"] >= steps
    assert f"| PPO | {found['curves']['ppo']['steps']:,} environment steps |" in (ROOT / "docs/benchmark.md").read_text()


# == Runs that touch nothing say so ==


@pytest.fixture
def warnings(caplog, monkeypatch):
    """warnings(): what has been logged since the last call."""
    monkeypatch.setattr(taxelsim._log, "_warned", set())

    def taken() -> list[str]:
        lines = [record.getMessage() for record in caplog.records]
        caplog.clear()
        return lines

    return taken


GRASP = """
format_version: 1
name: grasp
kind: grasp
robot: ROBOT
objects: [{box: {size_mm: [60, 30, 30]}, pose: {POSE}}]
grasp: {fingers: [FINGER]}
task: {hold: 0.05}
episode: {num_steps: 70, simulation_rate: 100}
record: [RECORD]
data_set: {episodes: 3, episodes_per_shard: 2}
"""


LEFT = "sensor: left, force: 2, joints: [{joint: jaw, velocity_mm: 50}]"
BELOW = "sensor: below, force: 0.5, joints: [{joint: bend, velocity_deg: -60}]"  # opens


def grasp(folder: Path, *, pose="position_mm: [0, 0, 0]", finger=LEFT, record="features") -> Path:
    words = {"ROBOT": taxelsim.SCENES / "robots/gripper.yaml", "POSE": pose, "FINGER": f"{{{finger}}}", "RECORD": record}
    text = GRASP
    for word, value in words.items():
        text = text.replace(word, str(value))
    (folder / "grasp.yaml").write_text(text)
    return folder / "grasp.yaml"


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"pose": "position_mm: [0, 500, 0]"}, "left: no contact in {0} of {0} episodes, nearest approach 0.45 m"),  # half a metre away
        ({"pose": "position: [0, 50, 0]"}, "left: no contact in {0} of {0} episodes, nearest approach 50 m"),  # millimetres
        ({"finger": BELOW}, "below: no contact in {0} of {0} episodes, nearest approach 0.023 m"),  # its first frame is the nearest
        ({}, None),
    ],
)
def test_a_grasp_that_touches_nothing_says_so_once(device, tmp_path, warnings, settings, message):
    for num_episodes, run in (
        (3, lambda scene: taxelsim.generate(scene, tmp_path / "out", device=device, batch_size=2)),
        (2, lambda scene: taxelsim.evaluate_grasp(scene, device=device, batch_size=2)),
    ):
        run(taxelsim.load_scene(grasp(tmp_path, **settings), num_episodes=num_episodes))
        found = warnings()
        assert len(found) == (1 if message else 0), found
        if message:
            expected = f": finger {message.format(num_episodes)}; check poses, their units, and the signs of closing velocities"
            assert found[0].endswith(expected), found


SERVO = """
format_version: 1
name: servo
sensor: SENSOR
kind: servo
objects: [sphere: {radius_mm: 10}]
episode: {num_steps: 3, simulation_rate: 100}
randomization: {START}
controller: {tactile_servo: {total_force: {kp: 1}}}
task: {total_force: {tolerance: 1}}
record: [RECORD]
data_set: {episodes: 3, episodes_per_shard: 2}
"""


def servo(folder: Path, start: str, record: str = "features", sensor: str = "sensors/wts0614_soft_cover.yaml") -> Path:
    text = SERVO.replace("SENSOR", str(taxelsim.SCENES / sensor)).replace("START", start).replace("RECORD", record)
    (folder / "servo.yaml").write_text(text)
    return folder / "servo.yaml"


@pytest.mark.parametrize(
    ("start", "end"),
    [
        ("depth: 0.5", "0.48 m; check the depth, and the units of poses"),
        ("depth_mm: 0.5", None),
        ("x: 0.9, depth_mm: 0.5", "0.88 m; check the depth, and the units of poses"),
        ("load: 0", "0 m; check the load, which is 0 N in them"),
        ("load: 1", None),
    ],
)
def test_a_scene_that_touches_nothing_says_so_once(device, tmp_path, warnings, start, end):
    scene = taxelsim.load_scene(servo(tmp_path, start))
    for name, run in (
        ("", lambda: taxelsim.generate(scene, tmp_path / "out", device=device, batch_size=2)),
        ("tactile_servo: ", lambda: taxelsim.evaluate(scene, device=device, batch_size=2)),
    ):
        run()
        found = warnings()
        assert [f"{name}no contact in 3 of 3 episodes, nearest start {end}" in line for line in found] == ([True] if end else []), found


def test_recorded_points_beside_the_array_are_noticed(device, tmp_path, warnings):
    columns = "episode,step,x_m,y_m,z_m,normal_force_N\n"
    (tmp_path / "points.csv").write_text(columns + "0,0,7.5,0,0,1\n2,0,0,0,0,1\n")  # millimetres, no point, and one that presses
    (tmp_path / "points.yaml").write_text(f"""
format_version: 1
name: points
kind: contact_points
sensor: {taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml"}
contact_points: {{file: points.csv}}
episode: {{num_steps: 1, simulation_rate: 100}}
record: [features]
""")
    taxelsim.generate(tmp_path / "points.yaml", tmp_path / "out", device=device)
    found = warnings()
    assert len(found) == 1
    assert "no contact in 1 of 3 episodes, nearest point 7.5 m; check the frame and the unit of the points" in found[0]


def test_shear_of_a_skin_without_friction_is_asked_about(tmp_path, warnings):
    message = "record: tactile_shear_force is 0 on the sensor"
    taxelsim.load_scene(servo(tmp_path, "load: 1", "features, tactile_shear_force"))
    (found,) = warnings()
    assert "servo.yaml:11:9: " + message + " wts0614_soft_cover: skin.friction_coefficient is 0" in found
    taxelsim.load_scene(grasp(tmp_path, record="tactile_shear_force"))
    (found,) = warnings()
    assert message + "s left, right, below" in found
    taxelsim.load_scene(servo(tmp_path, "load: 1", "tactile_shear_force", "sensors/uskin_like_4x4.yaml"))
    taxelsim.load_scene(servo(tmp_path, "load: 1"))
    assert warnings() == []


def test_a_simulator_that_gives_zeros_says_so_once(device, model, poses, warnings):
    touching = poses.copy()
    far, high = poses.copy(), poses.copy()
    far[:, 2] = 7.5  # millimetres
    high[:, 2] = 0.5  # approaches later
    cases = [
        ("read", None, "read() before the first step(): all arrays are 0"),
        ("step", None, "step() before set_objects(): nothing touches the sensor, all forces are 0"),
        ("step", far, "set_objects(): what is nearest is 7.5 m from the taxels, nothing touches; are positions in millimetres?"),
        ("step", high, None),
        ("step", touching, None),
    ]
    for call, given, message in cases:
        simulator = taxelsim.Simulator(model, len(poses))
        for _ in range(2):
            if given is not None:
                simulator.set_objects(0, given)
            if call == "step":
                simulator.step(0.01)
            simulator.read()
        found = warnings()
        assert [message in line for line in found] == ([True] if message else []), found
    empty = taxelsim.Simulator(model, len(poses))
    empty.set_objects(taxelsim.NO_OBJECT, far)  # on purpose
    empty.step(0.01)
    empty.read()
    points = taxelsim.Simulator(model, 1, max_contacts=2)
    for position, message in (([0, 0, 0], None), ([0, 7.5, 0], "set_contacts(): what is nearest is 7.48 m from the taxels")):
        points = taxelsim.Simulator(model, 1, max_contacts=2)
        points.set_contacts([position], [1.0], [0, 1])
        points.step(0.01)
        points.read()
        found = warnings()
        assert [message in line for line in found] == ([True] if message else []), found


def test_lengths_of_a_sensor_in_millimetres_are_asked_about(tmp_path, warnings):
    taxelsim.GridPatch(num_rows=6, num_cols=14, pitch=(3.41, 3.41))
    assert ["pitch: 3.41 m between taxels; is it in millimetres? Lengths are in metres" in line for line in warnings()] == [True]
    taxelsim.Skin(thickness=1.53, law=taxelsim.Winkler(normal_contact_stiffness=1e8))
    assert ["thickness: 1.53 m thick; is it in millimetres? Lengths are in metres" in line for line in warnings()] == [True]
    text = (taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").read_text()
    (tmp_path / "thick.yaml").write_text(text.replace("thickness_mm: 2 ", "thickness: 2 "))
    taxelsim.load_sensor(tmp_path / "thick.yaml")
    assert ["skin.thickness: 2 m thick; is it in millimetres? thickness_mm" in line for line in warnings()] == [True]
    for file in sorted((taxelsim.SCENES / "sensors").glob("*.yaml")):
        sensor = taxelsim.load_sensor(file)
        sensor.replace(skin=sensor.skin.replace(), patches=[patch.replace() for patch in sensor.patches])
    assert [line for line in warnings() if "millimetres" in line] == []


# == Sizes that look wrong are asked about ==


def write_cube(file: Path, size: float) -> Path:
    corners = "".join(f"v {x} {y} {z}\n" for x, y, z in itertools.product((0, size), repeat=3))
    file.write_text(corners + "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n")
    return file


def press(file: Path, sensor: str = "wts0614") -> subprocess.CompletedProcess[str]:
    command = [PROGRAM, "frame", "--sensor", taxelsim.SCENES / f"sensors/{sensor}.yaml", "--object", file, "--load", "1"]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)


@pytest.mark.parametrize(
    ("size", "question"),
    [
        (0.84, "the mesh is 0.84 m long; is the file in millimetres? scale: 0.001"),
        (0.02, None),
        (2.7e-6, "the mesh is 2.7e-06 m long; was it scaled twice? scale: 1000"),
    ],
)
def test_a_mesh_in_another_unit_is_asked_about(tmp_path, size, question):
    found = press(write_cube(tmp_path / "cube.obj", size))
    assert (question in found.stderr) if question else (found.stderr == "")


@pytest.mark.parametrize(
    ("sensor", "reason"),
    [("wts0614_soft_cover", "it lies outside of the array"), ("wts0614", "pressed through the skin, the objects carry ")],
)
def test_a_load_out_of_reach_names_the_size_of_the_object(tmp_path, sensor, reason):
    found = press(write_cube(tmp_path / "cube.obj", 2.7e-6), sensor)
    assert found.returncode == 2
    assert reason in found.stderr
    assert ": cube is 0.0027 x 0.0027 x 0.0027 mm; was it scaled twice?\n" in found.stderr


def test_no_shipped_scene_is_asked_about(capfd, caplog):
    for folder in (".", "tasks", "benchmark"):
        for file in sorted((taxelsim.SCENES / folder).glob("*.yaml")):
            taxelsim.load_scene(file)
    assert " m long" not in capfd.readouterr().err + caplog.text


def test_a_name_that_is_no_object_lists_the_formats():
    for name in ("cube.step", "ball:1"):
        with pytest.raises(taxelsim.InputError, match=r"\.obj, \.stl, \.ply, \.glb, \.gltf"):
            taxelsim.parse_object(name)


# == Meshes lie where a new user expects them ==


def test_the_lowest_point_of_a_mesh_is_placed_as_in_scenes(device, sensor, tmp_path):
    corner = taxelsim.load_mesh(write_cube(tmp_path / "cube.obj", 0.01))
    cube = taxelsim.Mesh(corner.vertices + np.array([0.5, 0, 0]), corner.triangles)  # its origin is half a metre away
    low, high = taxelsim.bounds_of(cube.centered())
    assert np.add(low, high) == pytest.approx(np.zeros(3), abs=1e-7)
    assert taxelsim.lowest_point(cube) == pytest.approx([0.505, 0.005, 0])
    simulator = taxelsim.Simulator(taxelsim.Model(device, sensor, [cube, taxelsim.Sphere(0.01)]), 4)
    simulator.set_loads(1)
    poses = np.tile([0, 0, 0, *taxelsim.axis_angle([1, 0, 0], 0.2)], (4, 1))
    reached = {}
    for anchor in ("origin", "lowest", taxelsim.lowest_point(cube, poses[0, 3:])):
        simulator.set_objects([0, 0, 1, 1], poses, anchor=anchor)
        simulator.step(0.01)
        frame = simulator.read().copy()
        reached[str(anchor)] = frame.ground_truth.load_reached.tolist()
        if anchor == "lowest":
            assert frame.center_of_pressure[:, :2] == pytest.approx(np.zeros((4, 2)), abs=2e-3)  # half a taxel
    assert list(reached.values()) == [[False, False, True, True], [True] * 4, [True, True, False, False]]
    with pytest.raises(taxelsim.InputError, match="anchor: 'middle' is not allowed: 'origin', 'lowest' or a point"):
        simulator.set_objects(0, poses, anchor="middle")


def test_loads_out_of_reach_are_warned_of_once(device, sensor, caplog):
    simulator = taxelsim.Simulator(taxelsim.Model(device, sensor, [taxelsim.Sphere(0.01)]), 3)
    simulator.set_objects(0, [[0, 0, 0.01, 1, 0, 0, 0], [0.5, 0, 0, 1, 0, 0, 0], [0.5, 0, 0, 1, 0, 0, 0]])
    simulator.set_loads(1)
    for _ in range(2):
        simulator.step(0.01)
        simulator.read()
    assert [record.getMessage()[:83] for record in caplog.records] == [
        "2 of 3 instances did not reach their load, instance 1 first (frame.ground_truth.loa"
    ]


def test_a_mesh_file_is_scaled_to_a_size(tmp_path):
    file = write_cube(tmp_path / "cube.obj", 700)
    assert taxelsim.bounds_of(taxelsim.load_mesh(file, size=0.03))[1] == pytest.approx([0.03, 0.03, 0.03])
    with pytest.raises(taxelsim.InputError, match="scale and size"):
        taxelsim.load_mesh(file, size=0.03, scale=0.001)
    with pytest.raises(taxelsim.InputError, match=r"size: 0 is not allowed"):
        taxelsim.load_mesh(file, size=0)


# == Noise alone is no contact ==


def test_noise_alone_is_no_contact(device, tmp_path):
    """Three standard deviations are the default trigger, in files and in Python; scenes keep the number that was used."""
    num_instances = 200
    patch = taxelsim.GridPatch(name="patch_0", num_rows=6, num_cols=14, pitch=(0.0034, 0.0034))
    skin = taxelsim.Skin(thickness=0.002, law=taxelsim.Winkler(normal_contact_stiffness=1e8))
    electronics = taxelsim.Readout(curve=[1000], noise=4)
    assert electronics.trigger == 0.012
    assert electronics.replace(noise=8).trigger == 0.012  # what is there stays
    assert taxelsim.Readout(curve=[1000], noise=4, trigger=0).trigger == 0
    assert taxelsim.Readout(curve=[1000], noise=4, taxel_trigger=[0.1] * 84).trigger == 0
    sensor = taxelsim.Sensor(name="noisy", patches=[patch], skin=skin, readout=electronics)
    text = taxelsim.sensor_text(sensor)
    (tmp_path / "sensor.yaml").write_text("".join(line for line in text.splitlines(True) if "trigger" not in line))
    from_file = taxelsim.load_sensor(tmp_path / "sensor.yaml")
    assert from_file == sensor
    resolved = taxelsim.load_scene(servo(tmp_path, "load: 1", sensor=str(tmp_path / "sensor.yaml"))).resolved
    assert "trigger: 0.012\n" in resolved

    simulator = taxelsim.Simulator(taxelsim.Model(device, from_file, [taxelsim.Sphere(radius=0.01)]), num_instances)
    simulator.set_objects(taxelsim.NO_OBJECT, np.tile([0, 0, 0, 1, 0, 0, 0], (num_instances, 1)))
    simulator.step(0.01)
    # A count shows above 3.125 standard deviations: 0.089 % of 16,800 taxels, 15 with a standard deviation of 3.9.
    assert np.count_nonzero(simulator.read().tactile_image) < 35


def test_a_file_whose_trigger_lets_noise_pass_is_noted(tmp_path):
    text = (taxelsim.SCENES / "sensors/wts0614_realistic.yaml").read_text()
    noted = []
    for trigger in ("0.042", "0.014", "0"):
        (tmp_path / "sensor.yaml").write_text(text.replace("trigger: 0.042", f"trigger: {trigger}"))
        command = [PROGRAM, "frame", "--sensor", tmp_path / "sensor.yaml", "--object", "sphere:0.01", "--pose", "0 0 0.0095"]
        lines = subprocess.run(command, capture_output=True, text=True, check=True).stderr.splitlines()
        noted.append([line for line in lines if "trigger" in line])
    message = "readout.trigger: 0.014 N is less than three standard deviations of the noise, 0.02125 N: taxels read without touch"
    assert noted == [[], [f"info: {tmp_path}/sensor.yaml:25:12: {message}"], [noted[1][0].replace("0.014 N", "0 N")]]


# == Warnings come once, through logging ==


def test_benchmarks_do_not_warn_about_themselves():
    command = """
import taxelsim
device = taxelsim.Device.open()
for file in sorted((taxelsim.SCENES / "benchmark").glob("*.yaml")):
    for condition in ("nominal", "randomized", "unseen"):
        scene = taxelsim.load_scene(file, condition=condition)
        taxelsim.Model(device, scene.sensor, scene.objects)
"""
    done = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_each_warning_is_logged_once(device, sensor, caplog):
    pin = taxelsim.Object(taxelsim.Cylinder(radius=0.0005, length=0.012), "pin of logging")
    for _ in range(2):
        taxelsim.Model(device, sensor, [pin])
    (record,) = caplog.records
    assert (record.name, record.levelname) == ("taxelsim", "WARNING")
    assert record.getMessage().startswith("object pin of logging is 1 mm wide, samples are 0.85 mm apart")


def test_warnings_of_any_thread(tmp_path, caplog):
    big = tmp_path / "big.obj"
    big.write_text("v 0 0 0\nv 36 0 0\nv 0 36 0\nv 0 0 36\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n")
    handled = []

    class Handler(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            taxelsim.parse_object("sphere:0.01")  # a handler may call the library
            handled.append(record.getMessage().split()[0 if "big.obj" in record.getMessage() else 1])

    logger, handler = logging.getLogger("taxelsim"), Handler()
    logger.addHandler(handler)
    texts = [f"sphere:{radius}" for radius in (31, 32, 33, 34)]
    threads = [threading.Thread(target=taxelsim.parse_object, args=(text,)) for text in texts[:3]]
    threads.append(threading.Thread(target=taxelsim.load_mesh, args=(big,)))  # which reads the file in a thread without Python
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    taxelsim.parse_object(texts[3])
    logger.removeHandler(handler)
    assert sorted(handled) == sorted([*(f"'{text}'" for text in texts), f"{big}:"])


def test_log_level_and_stderr():
    command = "import taxelsim; {}taxelsim.parse_object('sphere:35')"
    lines = []
    for setting in ("", "taxelsim.set_log_level('warning'); ", "taxelsim.set_log_level('error'); "):
        done = subprocess.run([sys.executable, "-c", command.format(setting)], capture_output=True, text=True)
        assert (done.returncode, done.stdout) == (0, "")
        lines.append(done.stderr)
    plain = "object 'sphere:35' is 70 m long"
    assert lines[0].startswith(plain)
    assert lines[1].startswith(f"warning: {plain}")
    assert [line.count("\n") for line in lines] == [1, 1, 0]
    with pytest.raises(taxelsim.InputError, match=r"^level: 'loud' is not allowed: debug, info, warning, error, off$"):
        taxelsim.set_log_level("loud")


# == Arguments of the wrong kind get one line ==


def test_names_files_and_single_numbers_are_taken(device, sensor, tmp_path):
    assert sensor.replace(depth_sampling="area").depth_sampling == taxelsim.DepthSampling.AREA
    assert taxelsim.GridPatch(pitch=0.002).pitch == [0.002, 0.002]
    assert taxelsim.Sphere(0.01) == taxelsim.Sphere(radius=0.01)
    file = write_cube(tmp_path / "cube.obj", 0.01)
    model = taxelsim.Model(device, taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml", [str(file), "sphere:0.01", taxelsim.Sphere(0.01)])
    assert model.sensor == sensor
    assert [each.name for each in model.objects] == ["cube", "sphere:0.01", "sphere"]
    assert taxelsim.Device.open(0).info.index == 0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda t: t.Model(t.device, 3), "Model(): sensor: int 3 is not allowed: Sensor, str or PathLike; use load_sensor()"),
        (lambda t: t.Model(t.device, t.sensor, [t.Sphere(0.01), 3]), "Model(): objects[1]: int 3 is not allowed: Object, Mesh, Sphere, "),
        (lambda t: t.Model(t.device, t.sensor, "cube.obj"), "Model(): objects: str 'cube.obj' is not allowed: Sequence[Object | Mesh | "),
        (lambda t: t.Model("cpu", t.sensor), "Model(): device: str 'cpu' is not allowed: Device; use Device.open()"),
        (lambda t: t.generate(t.scene, "out", device="cpu"), "generate(): device: str 'cpu' is not allowed: Device; use Device.open()"),
        (lambda t: t.Simulator(t.sensor), "Simulator(): model: Sensor is not allowed: Model"),
        (lambda t: t.Simulator(t.model, 1.5), "SimulatorOptions(): num_instances: float 1.5 is not allowed: int"),
        (lambda t: t.Simulator(t.model, seed=-1), "SimulatorOptions(): seed: -1 found, which is out of range"),
        (lambda t: t.simulator.step("0.01"), "Simulator.step(): dt: str '0.01' is not allowed: float"),
        (lambda t: t.Sphere("large"), "Sphere(): radius: str 'large' is not allowed: float"),
        (lambda t: t.Sphere(0.1, 0.2), "Sphere(): too many arguments without a name: radius"),
        (lambda t: t.Skin(0.002), "Skin(): too many arguments without a name: thickness, law, "),
        (lambda t: t.Box(size=(1, 2)), "Box(): size: 2 values are not allowed: 3"),
        (lambda t: t.GridPatch(pitch=0.002, num_rows=2**40), "GridPatch(): num_rows: 1099511627776 found, which is out of range"),
        (lambda t: t.Skin(thicknes=0.002), "Skin(): unknown argument thicknes: did you mean thickness?"),
        (lambda t: t.sensor.replace(skn=3), "Sensor(): unknown argument skn: did you mean skin?"),
        (lambda t: t.sensor.replace(depth_sampling="aera"), "Sensor(): depth_sampling: str 'aera' is not allowed: area, point"),
        (lambda t: t.sensor.replace(patches=[3]), "Sensor(): patches[0]: int 3 is not allowed: GridPatch"),
        (lambda t: t.sensor.replace(skin=None), "Sensor(): skin: None is not allowed: Skin"),
        (lambda t: t.Device("cpu"), "Device() is no constructor: use Device.open()"),
        (lambda t: t.Scene("x.yaml"), "Scene() is no constructor: use load_scene()"),
        (lambda t: t.load_mesh(), "load_mesh(): missing a required argument: 'file'"),
        (lambda t: t.load_mesh(3), "load_mesh(): file: int 3 is not allowed: str or PathLike"),
        (lambda t: t.Mesh([[0, 1], [1, 0], [1, 1]], [[0, 1, 2]]), "vertices: shape (3, 2) is not allowed: (V, 3); did you mean array.T?"),
        (lambda t: t.simulator.read().taxel_counts, "Frame has no taxel_counts: wts0614_soft_cover has one-axis taxels"),
    ],
)
def test_wrong_arguments_are_one_line(device, sensor, model, call, message):
    simulator = taxelsim.Simulator(model, 1)
    names = {name: getattr(taxelsim, name) for name in taxelsim.__all__}
    scene = taxelsim.SCENES / "edge_servo.yaml"
    touched = SimpleNamespace(**{**names, "device": device, "sensor": sensor, "model": model, "scene": scene, "simulator": simulator})
    with pytest.raises((taxelsim.InputError, AttributeError)) as caught:
        call(touched)
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)
    assert not isinstance(caught.value, taxelsim.ArgumentError) or isinstance(caught.value, TypeError)


def test_an_unknown_device_is_told_what_vulkan_has():
    with pytest.raises(taxelsim.DeviceError) as caught:
        taxelsim.Device.open("cuda")
    for word in ('"cuda"', "Vulkan", "gpu", "cpu", "ICD", taxelsim.list_devices()[0].name):
        assert word in str(caught.value)


def test_an_onnx_file_with_several_inputs_is_told_how_to_choose_observations():
    policy = OnnxPolicy.__new__(OnnxPolicy)  # without a file, which would need onnx
    policy.file, policy.batch_size = Path("three.onnx"), None
    policy._inputs = [SimpleNamespace(name=name) for name in ("contact", "features", "proprioception")]
    with pytest.raises(taxelsim.InputError) as caught:
        policy(np.zeros((2, 6)))
    assert "--observations contact,features,proprioception, or Policy(..., observations=('contact', " in str(caught.value)


# == inspect says what it verified ==


def test_inspect_says_that_nothing_has_changed(tmp_path):
    command = [PROGRAM, "generate", servo(tmp_path, "load: 1"), "-o", tmp_path / "out", "--episodes", "8"]
    subprocess.run(command, capture_output=True, check=True)
    subprocess.run([PROGRAM, "finish", tmp_path / "out"], capture_output=True, check=True)

    def inspected(*options: str) -> str:
        return subprocess.run([PROGRAM, "inspect", tmp_path / "out", *options], capture_output=True, text=True, check=True).stdout

    sentence = "scene verified; 4 of 4 shards unchanged since they were verified (sizes and times); --verify reads all bytes"
    assert sentence in inspected()
    assert "scene and all bytes of all shards on disk verified" in inspected("--verify")
    (tmp_path / "out/shard-000001.h5").touch()
    assert sentence.replace("4 of", "3 of").replace("times);", "times), all bytes of 1 verified now;") in inspected()


# == Typos are found before the program runs ==


def test_native_classes_have_signatures():
    names = [name for name in taxelsim.__all__ if getattr(getattr(taxelsim, name), "__module__", "") == "taxelsim._core"]
    members = [getattr(taxelsim, name) for name in names]
    with_constructor = [each for each in members if not isinstance(each, type) or "__signature__" in vars(each)]
    assert len(with_constructor) > 60
    for member in with_constructor:
        inspect.signature(member)
    assert str(inspect.signature(taxelsim.Sphere)) == "(radius: 'float' = 0.0)"
    assert str(inspect.signature(taxelsim.Sphere.replace)) == "(self, *, radius: 'float' = Ellipsis) -> 'Self'"
    assert list(inspect.signature(taxelsim.Model).parameters) == ["device", "sensor", "objects", "contact_workgroup", "image_workgroup"]
    assert list(inspect.signature(taxelsim.load_mesh).parameters) == ["file", "scale", "size", "up_axis", "max_depth_error"]


def test_make_vec_takes_the_arguments_of_its_class():
    keywords = [name for name, each in inspect.signature(TactileVectorEnv).parameters.items() if each.kind == each.KEYWORD_ONLY]
    assert sorted(VectorEnvArguments.__annotations__) == sorted(keywords)


def test_mypy_finds_typos(tmp_path):
    file = tmp_path / "typos.py"
    file.write_text(
        "import taxelsim\n"
        "sphere = taxelsim.Sphere(0.01).replace(radius=0.02)\n"
        "image: int = taxelsim.Dataset('out')['data/tactile_image'][3:7]  # E\n"
        "taxelsim.make_vec('scene.yaml', observatons='contact')  # E\n"
        "sphere.replace(radios=0.02)  # E\n"
        "taxelsim.Sensor(depth_sampling='area').replace(depth_sampling='point')\n"
        "taxelsim.GridPatch(pitch=0.002)\n"
    )
    package = Path(taxelsim.__file__).parent
    command = [sys.executable, "-m", "mypy", "--config-file", str(ROOT / "pyproject.toml"), "--cache-dir", str(tmp_path), str(file)]
    done = subprocess.run(command, env={**os.environ, "MYPYPATH": str(package.parent)}, capture_output=True, text=True, check=False)
    found = [int(line.split(":")[1]) for line in done.stdout.splitlines() if "error:" in line and "typos.py" in line]
    assert found == [3, 4, 5], done.stdout + done.stderr


# == Documents run as they are printed ==


@pytest.mark.parametrize(
    ("page", "smaller"),
    [
        ("python.md", {"N = 4096": "N = 8"}),
        ("environments.md", {"num_envs=4096": "num_envs=2", "num_episodes=100": "num_episodes=2"}),
    ],
)
def test_blocks_of_a_page_run_as_one_program(page, smaller, monkeypatch, tmp_path):
    text = (ROOT / "docs" / page).read_text()
    monkeypatch.chdir(tmp_path)
    program = "\n".join(re.findall(r"```python\n(.*?)```", text, re.DOTALL))
    for printed, small in smaller.items():
        assert printed in program
        program = program.replace(printed, small)
    names: dict = {}
    exec(compile(program, page, "exec"), names)
    for sensor in (value for value in names.values() if isinstance(value, taxelsim.Sensor)):
        taxelsim.check_sensor(sensor)


def test_folders_of_the_documents_are_ignored_by_git():
    assert {"build/", "venv/"} <= set((ROOT / ".gitignore").read_text().split())


# == No code of the current folder runs ==

FORMAT_1 = ROOT / "tests/dataset/data/format_1"
THIS_PYTHON = {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}  # as python3
PACKAGES = ("taxelsim", "numpy", "h5py", "rerun", "rerun_cli", "pyarrow", "av", "PIL", "onnxruntime")
IN_THE_FOLDER = {
    "report": ([], 2),
    "export": (["--format", "zarr", "-o", "out"], 0),
    "view": (["--save", "a.rrd"], 0),
    "import": (["--sensor", "a.yaml", "--measurement", "stamp", "-o", "b.yaml"], 2),
    "finish": (["--card"], 2),
    "render": (["--episode", "0", "-o", "a.mp4"], 2),
    "evaluate": (["--policy", "a.onnx"], 2),
}


@pytest.fixture
def trapped(tmp_path):
    """A data set next to a Python file of the name of every module; their code writes the file `ran`."""
    folder = Path(shutil.copytree(FORMAT_1, tmp_path / "data"))
    for name in (*sys.stdlib_module_names, *PACKAGES, "sitecustomize", "usercustomize"):
        (folder / f"{name}.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'a').write({name!r})\nraise SystemExit(97)\n")
    return folder


def run_trapped(folder, command, **environment):
    # The empty entry of PYTHONPATH is the current folder, too.
    variables = {**THIS_PYTHON, "PYTHONPATH": f"{Path(taxelsim.__file__).parents[1]}:", **environment}
    done = subprocess.run(command, cwd=folder, env=variables, capture_output=True, text=True)
    assert not (folder.parent / "ran").exists(), (folder.parent / "ran").read_text()
    return done


@pytest.mark.parametrize("name", IN_THE_FOLDER)
def test_no_subcommand_runs_python_files_of_the_current_folder(trapped, name):
    words, status = IN_THE_FOLDER[name]
    done = run_trapped(trapped, [PROGRAM, name, ".", *words])
    assert done.returncode == status, done.stderr


def test_the_web_viewer_is_not_taken_from_the_current_folder(trapped):
    done = run_trapped(trapped, [PROGRAM, "view", ".", "--web"], RERUN_CLI_PATH="/bin/true")
    assert (done.returncode, "Ctrl-C ends" in done.stderr) == (0, True), done.stderr


def test_modules_that_the_package_imports_are_not_taken_from_the_current_folder(trapped):
    for file in trapped.glob("*.py"):
        if file.stem not in PACKAGES[1:]:  # what Python imports before the package, and the package, cannot be protected
            file.unlink()
    command = [sys.executable, "-m", "taxelsim", "view", ".", "--save", "a.rrd"]
    done = run_trapped(trapped, command, PYTHONPATH=str(Path(taxelsim.__file__).parents[1]))
    assert done.returncode == 0, done.stderr


# == Damaged glTF is refused by name ==

CUBE = np.array(list(itertools.product((0, 0.01), repeat=3)), np.float32)
FACES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
)


def cube_json() -> dict[str, Any]:
    """glTF of a cube with sides of 10 mm."""
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
        "buffers": [{"byteLength": 168}],
    }


def write_glb(file: Path, text: str, buffer: bytes = CUBE.tobytes() + FACES.astype(np.uint16).tobytes()) -> Path:
    content = text.encode()
    content += b" " * (-len(content) % 4)
    chunks = [struct.pack("<I4s", len(chunk), kind) + chunk for kind, chunk in ((b"JSON", content), (b"BIN\0", buffer))]
    file.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + sum(map(len, chunks))) + b"".join(chunks))
    return file


def test_a_whole_cube_is_read(tmp_path):
    mesh = taxelsim.load_mesh(write_glb(tmp_path / "cube.glb", json.dumps(cube_json())))
    assert sorted(map(tuple, mesh.vertices)) == sorted(map(tuple, CUBE))
    assert len(mesh.triangles) == 12


FAR = {"bufferView": 0, "byteOffset": 1 << 31}
REFUSED_GLTF = {
    "sparse": ({"accessors.0.sparse": {"count": 2, "indices": {**FAR, "componentType": 5123}, "values": FAR}}, "accessors[0].sparse: "),
    "short joints": (
        {"accessors.2": {"count": 2, "componentType": 5121, "type": "VEC4"}, "meshes.0.primitives.0.attributes.JOINTS_0": 2},
        "accessors[2].count: 2 is not allowed: 8, the count of meshes[0].primitives[0].attributes.POSITION",
    ),
    "VEC2": ({"accessors.0.type": "VEC2"}, 'accessors[0].type: "VEC2" is not allowed: VEC3 for POSITION'),
    "BYTE": ({"accessors.1.componentType": 5120}, "accessors[1].componentType: 5120 is not allowed: 5121, 5123 or 5125 for indices"),
    "extension": ({"extensionsRequired": ["EXT_other"]}, "it requires the extension EXT_other, which is not read"),
    "offset": ({"bufferViews.1.byteOffset": 97}, "bufferViews[1].byteLength: 72 is not allowed: a whole number up to 71"),
    "wrap": ({"accessors.0.byteOffset": (1 << 64) - 8}, "accessors[0].byteOffset: "),
    "index": ({"bufferViews.1.byteOffset": 0}, "meshes[0].primitives[0]: index "),
    "two parents": ({"scenes.0.nodes": [0, 0]}, "its nodes are not a tree"),
    "cycle": ({"nodes.0.children": [0]}, "its nodes are not a tree"),
    "other file": ({"buffers.0.uri": "/dev/zero"}, "which its SHA-256 does not cover"),
}


@pytest.mark.parametrize("name", REFUSED_GLTF)
def test_damaged_gltf_is_one_line(tmp_path, name):
    changes, message = REFUSED_GLTF[name]
    document = cube_json()
    for path, value in changes.items():
        *parents, key = path.split(".")
        item: Any = document
        for parent in parents:
            item = item[int(parent) if isinstance(item, list) else parent]
        if isinstance(item, list):
            item.insert(int(key), value)
        else:
            item[key] = value
    with pytest.raises(taxelsim.InputError) as refusal:
        taxelsim.load_mesh(write_glb(tmp_path / "cube.glb", json.dumps(document)))
    assert message in str(refusal.value)


def test_a_key_twice_is_refused_whichever_counts(tmp_path):
    chain = [{"children": [i, i]} for i in range(1, 31)] + [{"mesh": 0}]  # 2^30 nodes
    text = json.dumps(cube_json())
    for nodes in (json.dumps(chain), "[" + '{"children":[1]},' * 100_000 + "{}]"):
        for doubled in (f'{{"nodes":{nodes},{text[1:]}', f'{text[:-1]},"nodes":{nodes}}}'):
            with pytest.raises(taxelsim.InputError, match='its JSON has the key "nodes" twice in one object'):
                taxelsim.load_mesh(write_glb(tmp_path / "cube.glb", doubled))


def test_quantized_positions_are_read(tmp_path):
    document = cube_json()
    document["extensionsRequired"] = ["KHR_mesh_quantization"]
    document["accessors"][0] |= {"componentType": 5122, "normalized": True}
    document["nodes"][0]["scale"] = [0.02, 0.02, 0.02]
    document["bufferViews"] = [{"buffer": 0, "byteLength": 62, "byteStride": 8}, {"buffer": 0, "byteOffset": 64, "byteLength": 72}]
    document["buffers"][0]["byteLength"] = 136
    shorts = np.zeros((8, 4), np.int16)
    shorts[:, :3] = np.where(CUBE > 0, 16000, 0)
    file = write_glb(tmp_path / "cube.glb", json.dumps(document), shorts.tobytes() + FACES.astype(np.uint16).tobytes())
    np.testing.assert_allclose(np.ptp(taxelsim.load_mesh(file).vertices, axis=0), 0.02 * 16000 / 32767, rtol=1e-6)


def test_a_pipe_as_buffer_does_not_block(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    document = cube_json()
    document["buffers"][0]["uri"] = "pipe"
    file = tmp_path / "cube.gltf"
    file.write_text(json.dumps(document))
    assert 'buffers[0].uri: "pipe": not a regular file' in press(file).stderr


# == Hostile data sets and folders ==


@pytest.fixture(scope="module")
def two_episodes(tmp_path_factory, device):
    folder = tmp_path_factory.mktemp("two")
    taxelsim.generate(write_scene(folder), folder / "out", device=device, episodes=range(2))
    return folder / "out"


@pytest.fixture
def hostile(two_episodes, tmp_path):
    """A data set that a test may change."""
    return Path(shutil.copytree(two_episodes, tmp_path / "hostile"))


def links_to_another_file(file, other, num_rows):
    h5py = pytest.importorskip("h5py")
    del file["data/time"]
    file["data/time"] = h5py.ExternalLink(other, "/data/time")


def links_to_another_group(file, other, num_rows):
    h5py = pytest.importorskip("h5py")
    del file["data"]
    file["data"] = h5py.ExternalLink(other, "/data")


def links_within_the_file(file, other, num_rows):
    h5py = pytest.importorskip("h5py")
    file.move("data/time", "time")
    file["data/time"] = h5py.SoftLink("/time")


def stores_rows_elsewhere(file, other, num_rows):
    del file["data/time"]
    file.create_dataset("data/time", (num_rows,), "<f8", external=[(other, 0, 8 * num_rows)])


def shows_rows_of_another_file(file, other, num_rows):
    h5py = pytest.importorskip("h5py")
    del file["data/time"]
    layout = h5py.VirtualLayout((num_rows,), "<f8")
    layout[:] = h5py.VirtualSource(other, "data/time", (num_rows,))
    file.create_virtual_dataset("data/time", layout)


HOSTILE = {
    links_to_another_file: "data/time is a link",
    links_to_another_group: "is a link",
    links_within_the_file: "data/time is a link",
    stores_rows_elsewhere: "column data/time is not stored in this file",
    shows_rows_of_another_file: "column data/time is not stored in this file",
}


def change_shard(folder, change, other):
    """Changes the shard as an attacker does, who renews its checksum."""
    shard = folder / "shard-000000.h5"
    with pytest.importorskip("h5py").File(shard, "r+") as file:
        change(file, os.fspath(other), len(file["data/time"]))
    shard.with_name(f"{shard.name}.sha256").write_text(f"{hashlib.sha256(shard.read_bytes()).hexdigest()}  {shard.name}\n")


@pytest.mark.parametrize("change", HOSTILE)
@pytest.mark.parametrize("isolated", [False, True])
def test_a_data_set_reads_its_own_files_only(two_episodes, hostile, change, isolated):
    change_shard(hostile, change, two_episodes / "shard-000000.h5")
    data = taxelsim.Dataset(hostile, isolated=isolated)
    with pytest.raises(taxelsim.InputError, match=rf"shard-000000\.h5: .*{HOSTILE[change]}"):
        data.frames(0)


@pytest.mark.parametrize(
    "name", ["dataset.yaml", "dataset.h5", "dataset.h5.sha256", "shard-000000.h5", "shard-000000.h5.sha256", "elsewhere"]
)
def test_a_fifo_does_not_block(hostile, name):
    (hostile / name).unlink(missing_ok=True)
    os.mkfifo(hostile / name)
    if name == "elsewhere":
        change_shard(hostile, stores_rows_elsewhere, hostile / name)
    for isolated in (False, True):
        code = f"import taxelsim; taxelsim.Dataset({str(hostile)!r}, isolated={isolated}).frames(0)"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
        last = done.stderr.splitlines()[-1:]
        if not (isolated and name.startswith("dataset.h5")):  # the shards have the same numbers
            assert "".join(last).startswith("taxelsim.errors.InputError"), done.stderr


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("episodes_per_shard: ", "episodes_per_shard: 0  # "),
        ("compression: 0", "compression: 12"),
        ("name: data/time", "name: meta/episode_ends"),
        ("kp: 4", "kp: 5"),  # of the scene, whose SHA-256 is in the manifest
        ("format_version: 2", "format_version: 3"),
    ],
)
def test_data_sets_are_refused_for_the_same_manifests_as_by_inspect(hostile, old, new):
    manifest = hostile / "dataset.yaml"
    assert old in manifest.read_text()
    manifest.write_text(manifest.read_text().replace(old, new, 1))
    inspected = subprocess.run([PROGRAM, "inspect", hostile], capture_output=True, text=True)
    assert inspected.returncode == 2
    for isolated in (False, True):
        with pytest.raises(taxelsim.InputError) as caught:
            taxelsim.Dataset(hostile, isolated=isolated)
        assert inspected.stderr == f"taxelsim: {caught.value}\n"


def test_a_shard_that_hangs_its_reader_ends_within_ten_seconds(tmp_path):
    fuzz = ROOT / "tests/fuzz"
    shutil.copy(fuzz / "data/format_1.yaml", tmp_path / "dataset.yaml")
    shutil.copy(fuzz / "corpus/shard_1/bitflip_hang.h5", tmp_path / "shard-000000.h5")
    shutil.copy(fuzz / "corpus/shard_1/plain.h5", tmp_path / "shard-000001.h5")
    done = subprocess.run([PROGRAM, "inspect", tmp_path], capture_output=True, text=True, timeout=10)
    assert done.returncode == 2
    assert "shard-000000.h5: broken or hostile file: reading it took more than 5 s" in done.stderr


def test_a_folder_without_permission_is_not_an_empty_one(hostile):
    code = f"""
import os, pathlib, h5py, taxelsim
folder = pathlib.Path({str(hostile)!r})
folder.chmod(0)
if os.getuid() == 0:
    os.setuid(65534)  # permissions do not bind root
for isolated in (False, True):
    try:
        taxelsim.Dataset(folder, isolated=isolated)
    except taxelsim.IoError as error:
        print(error)
try:
    taxelsim.load_scene(folder / "scene.yaml")
except taxelsim.Error as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    hostile.chmod(0o755)
    assert [line.partition(": ")[2] for line in done.stdout.splitlines()] == 2 * ["Permission denied"] + [
        "cannot be read: Permission denied"
    ]


def test_a_byte_order_mark_is_no_part_of_a_mesh(tmp_path):
    file = write_cube(tmp_path / "cube.obj", 0.01)
    plain = taxelsim.load_mesh(file)
    file.write_bytes(b"\xef\xbb\xbf" + file.read_bytes())
    assert taxelsim.load_mesh(file) == plain


def test_a_hundred_thousand_parts_are_pressed_or_refused(tmp_path):
    document = cube_json()
    document["scenes"][0]["nodes"] = list(range(100_000))
    document["nodes"] = [{"mesh": 0, "translation": [0.02 * (i % 300), 0.02 * (i // 300), 0]} for i in range(100_000)]
    found = press(write_glb(tmp_path / "parts.glb", json.dumps(document)))
    assert found.returncode in (0, 2), found.stderr


def wait_for(process, text):
    """Until the process has mapped a file whose name has the text."""
    deadline = time.monotonic() + 60
    while text not in Path(f"/proc/{process.pid}/maps").read_text():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.002)


@pytest.mark.parametrize("command", [[PROGRAM], [sys.executable, "-m", "taxelsim"]], ids=["program", "package"])
@pytest.mark.parametrize("moment", ["python3", "_multiarray_umath", "rerun_bindings", "viewer"])
def test_ctrl_c_prints_no_traceback(interruptible, tmp_path, command, moment):
    pytest.importorskip("rerun")
    if (moment, len(command)) == ("python3", 3):
        moment = "/_core."  # before, Python answers by itself
    viewer = tmp_path / "viewer"
    viewer.write_text("#!/bin/sh\nexec sleep 60\n")
    viewer.chmod(0o755)
    environment = {**THIS_PYTHON, "RERUN_CLI_PATH": os.fspath(viewer)}
    with subprocess.Popen(
        [*command, "view", FORMAT_1, "--web"], stderr=subprocess.PIPE, text=True, env=environment, start_new_session=True
    ) as process:
        assert process.stderr is not None
        if moment == "viewer":
            assert any("Using overridden" in line for line in iter(process.stderr.readline, ""))
        else:
            wait_for(process, moment)
        os.killpg(process.pid, signal.SIGINT)
        assert (process.stderr.read(), process.wait(60)) == ("", 130)
