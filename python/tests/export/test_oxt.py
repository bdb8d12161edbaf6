"""Open-X-Tactile: arrays, their places, the rules of the contract, and the way back to measurements."""

import importlib
import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import taxelsim
from taxelsim.export import Options, export
from taxelsim.program import PROGRAM
from taxelsim.recordings import Measurement, read_oxt, write_measurement

from ..envs.conftest import write_scene
from .conftest import NUM_EPISODES, NUM_FRAMES, files_of

zarr = pytest.importorskip("zarr")
oxt = pytest.importorskip("taxelsim.export.oxt")
rules = pytest.importorskip("taxelsim.export.oxt_rules")
layout = pytest.importorskip("taxelsim.export.oxt_layout")

PLACE = ("left=0", "right=left:1", "below=2")
SENSOR = taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml"
TOUCH = "right_tactile_{}_wts0614_soft_cover"


@pytest.fixture(scope="module")
def grasped(tmp_path_factory, device):
    """Two episodes of a gripper with three sensors."""
    folder = tmp_path_factory.mktemp("grasped") / "data"
    taxelsim.generate(taxelsim.SCENES / "gripper_grasp.yaml", folder, episodes=range(2), device=device)
    return folder


@pytest.fixture(scope="module")
def exported_grasp(grasped, tmp_path_factory):
    out = tmp_path_factory.mktemp("oxt") / "grasp.zarr"
    export(grasped, out, "oxt", Options(place=PLACE, joints=("left:bend", "right:jaw=28"), columns=("data/left/total_force",)))
    return out


@pytest.fixture
def copied_grasp(exported_grasp, tmp_path):
    return Path(shutil.copytree(exported_grasp, tmp_path / "copied.zarr"))


def test_sensors_of_one_side_and_model_are_a_group(grasped, exported_grasp):
    data, root = taxelsim.Dataset(grasped), zarr.open_group(exported_grasp, mode="r")
    arrays = root["data"]
    np.testing.assert_array_equal(root["meta/episode_ends"][:], data.episode_ends)
    assert root.metadata.zarr_format == 2
    touch = arrays["right_tactile_data_fingertip_6x4"]
    assert (touch.shape, touch.dtype) == ((data.num_frames, 2, 6, 4), np.float32)
    for index, name in enumerate(("left", "below")):
        np.testing.assert_array_equal(touch[:, index], data[f"data/{name}/tactile_image"][:])
    np.testing.assert_array_equal(arrays["left_tactile_data_wts0614_soft_cover"][:, 0], data["data/right/tactile_image"][:])
    np.testing.assert_array_equal(arrays["right_tactile_area_fingertip_6x4"][[0, -1]], [[0, 2], [0, 2]])
    np.testing.assert_array_equal(arrays["left_tactile_area_wts0614_soft_cover"][:], np.ones((data.num_frames, 1)))
    assert set(arrays["right_tactile_sensor_fingertip_6x4"][:].tolist()) == {"fingertip_6x4"}
    assert set(arrays["right_tactile_type_fingertip_6x4"][:].tolist()) == {"state"}
    joints = data["data/robot/joint_position"][:]
    np.testing.assert_array_equal(arrays["right_hand_joints"][:], joints[:, :1])
    np.testing.assert_array_equal(arrays["left_arm_joints"][:], joints[:, 1:])
    assert (arrays["right_hand_joints_idx"][:] == 28).all()
    np.testing.assert_array_equal(arrays["timestamps"][:], data["data/time"][:])
    np.testing.assert_array_equal(arrays["left_total_force"][:, 0], data["data/left/total_force"][:])
    assert set(arrays["sub_task_instruction"][:].tolist()) == {"gripper_grasp: box"}
    assert set(arrays) >= {"left_wrist_pose", "camera_main_rgb"}
    assert "right_wrist_pose" not in arrays  # the set does not say which of the two sensors has the pose
    assert root.attrs["rgb"]["shows"].startswith("drawn, no camera")


def test_the_only_sensor_is_a_pad_whose_pose_is_the_wrist(folder, exported):
    """Rotation vectors are those of MuJoCo."""
    mujoco = pytest.importorskip("mujoco")
    arrays = zarr.open_group(exported("oxt"), mode="r")["data"]
    poses = taxelsim.Dataset(folder)["data/sensor_pose"][:]
    np.testing.assert_array_equal(arrays["right_wrist_pose"][:, :3], poses[:, :3])
    for row, pose in enumerate(poses):
        expected = np.empty(3)
        mujoco.mju_quat2Vel(expected, pose[3:], 1)
        np.testing.assert_allclose(arrays["right_wrist_pose"][row, 3:], expected, atol=1e-12)
    assert (arrays[TOUCH.format("area")][:] == 0).all()
    assert not [name for name in arrays if "joints" in name]


def test_rotation_vectors_turn_back():
    poses = np.random.default_rng(1).normal(size=(100, 7))
    poses[0, 3:] = 1, 0, 0, 0
    poses[1, 3:] = 1, 1e-9, 0, 0
    poses[:, 3:] /= np.linalg.norm(poses[:, 3:], axis=1, keepdims=True)
    vectors = layout.rotation_vectors(poses)
    assert np.linalg.norm(vectors[:, 3:], axis=1).max() <= np.pi
    poses[:, 3:] *= np.sign(poses[:, 3:4])
    np.testing.assert_allclose(layout.quaternion_poses(vectors), poses, atol=1e-14)


def test_several_sensors_in_one_column_are_pads(two_sensors, tmp_path):
    export(two_sensors, tmp_path / "out", "oxt", Options(wrist=("1",), joints=("none",)))
    arrays, data = zarr.open_group(tmp_path / "out", mode="r")["data"], taxelsim.Dataset(two_sensors)
    np.testing.assert_array_equal(arrays[TOUCH.format("data")][:], data["data/tactile_image"][:])
    np.testing.assert_array_equal(arrays[TOUCH.format("area")][0], [0, 1])
    np.testing.assert_array_equal(arrays["right_wrist_pose"][:, :3], data["data/sensor_pose"][:, 1, :3])


def test_three_axis_counts_are_a_group_with_one_more_axis(tmp_path, device):
    file = write_scene(tmp_path, record="tactile_image, taxel_counts, poses")
    text = file.read_text().replace("wts0614_soft_cover.yaml", "uskin_like_4x4.yaml")
    file.write_text(text.replace("episodes: 24", "episodes: 2"))
    taxelsim.generate(file, tmp_path / "data", device=device)
    export(tmp_path / "data", tmp_path / "out", "oxt")
    arrays, data = zarr.open_group(tmp_path / "out", mode="r")["data"], taxelsim.Dataset(tmp_path / "data")
    (name,) = (name for name in arrays if name.endswith("_axes") and "data" in name)
    np.testing.assert_array_equal(arrays[name][:, 0], data["data/taxel_counts"][:])
    assert (arrays[name].shape[1:], data["data/taxel_counts"][:].min() < 0) == ((1, 4, 4, 3), True)
    recording = read_oxt(tmp_path / "out")
    np.testing.assert_array_equal(recording.column(f"{name}.a0_r3_c1_2"), data["data/taxel_counts"][:, 3, 1, 2])


def test_pictures_of_arrays(folder, exported):
    arrays = zarr.open_group(exported("oxt", range=500.0), mode="r")["data"]
    pictures, counts = arrays["camera_main_rgb"][:], taxelsim.Dataset(folder)["data/tactile_image"][:]
    assert pictures.shape == (NUM_EPISODES * NUM_FRAMES, 24, 56, 3)
    np.testing.assert_allclose(pictures[:, ::4, ::4], taxelsim.pictures.colours_of(counts / 500), atol=3)  # one level of the scale
    np.testing.assert_array_equal(pictures[:, 3::4, 3::4], pictures[:, ::4, ::4])


def test_pictures_of_the_scene(exported):
    pytest.importorskip("taxelsim._pictures")
    arrays = zarr.open_group(exported("oxt", camera="scene", episodes=(8, 9)), mode="r")["data"]
    pictures = arrays["camera_main_rgb"]
    assert pictures.shape == (2 * NUM_FRAMES, 192, 225, 3)
    assert (pictures[0] != pictures[NUM_FRAMES]).any()
    assert "taxelsim render" in pictures.attrs["shows"]


def test_an_interrupted_export_continues_to_the_same_bytes(folder, exported, tmp_path, monkeypatch):
    monkeypatch.setattr(oxt, "MAX_PIECE", 16)
    monkeypatch.setattr(oxt, "CHUNK_BYTES", 8 * 24 * 56 * 3)
    whole = files_of(exported("oxt", "whole"))

    def stop(done, total):
        if done > 50:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        export(folder, tmp_path / "resumed", "oxt", Options(), stop)
    assert not (tmp_path / "resumed").exists()
    (tmp_path / "resumed.incomplete/data/camera_main_rgb/8.0.0.0").write_bytes(b"torn")
    progress = []
    export(folder, tmp_path / "resumed", "oxt", Options(), lambda done, total: progress.append(done))
    assert progress[0] == 64
    assert files_of(tmp_path / "resumed") == whole


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"place": ()}, r"place: the functional area of sensor 'left' is not known: --place left=N, 0 to 4"),
        ({"place": ("left=0", "right=24", "below=2")}, "place: right: '24' is not allowed: an integer from 0 to 23"),
        ({"place": ("left=0", "right=up:1", "below=2")}, "place: 'right=up:1' is not allowed: NAME=VALUE or NAME=SIDE:VALUE"),
        ({"place": ("left=0", "left=1", "below=2")}, "place: 'left' found twice"),
        ({"place": (*PLACE, "thumb=3")}, "place: 'thumb' is not allowed: a sensor of"),
        ({"place": ("left=0", "right=left:1", "below=0")}, "place: area 0 of right_fingertip_6x4 found twice"),
        ({"joints": ()}, "joints: the slots of joints jaw, bend are not known: --joints jaw=SLOT,bend=SLOT, ... with 0 to 31"),
        ({"joints": ("right:jaw=32",)}, "joints: jaw: '32' is not allowed: an integer from 0 to 31"),
        ({"joints": ("jaw=28",)}, "joints: 'jaw=28' is not allowed: SIDE:jaw=28, since both sides have sensors"),
        ({"joints": ("right:grip",)}, "joints: 'grip' is not allowed: jaw, bend"),
        ({"joints": ("right:jaw=1", "right:bend=1")}, "joints: slot 1 of the right side found twice"),
        ({"place": ("left=0", "right=1", "below=2")}, "no pose of a wrist and no joints, from which FTP-1 derives actions"),
        ({"wrist": ("palm",)}, "wrist: 'palm' is not allowed: left, right, below"),
        ({"camera": "eye"}, "camera: 'eye' is not allowed: arrays, scene"),
        ({"columns": ("data/left/total_force", "data/left/sensor_pose"), "camera": "eye"}, "camera: 'eye'"),
        ({"state": ("data/left/total_force",)}, "state: not an option of format oxt"),
    ],
)
def test_what_is_not_known_is_asked_for(grasped, tmp_path, options, message):
    with pytest.raises(taxelsim.InputError, match=message):
        export(grasped, tmp_path / "out", "oxt", Options(**{"place": PLACE, "joints": ("none",), **options}))
    assert not list(tmp_path.iterdir())


def test_an_export_keeps_every_rule(exported_grasp):
    findings = rules.check(rules.open_store(exported_grasp))
    assert len(findings) == len(rules.RULES)
    assert [faults for rule, faults in findings if faults] == [
        ["left_hand_joints: missing, and FTP-1 then reads neither touch nor poses of the left side"]
    ]
    assert all(rule.source for rule in rules.RULES)


def replaced(root, name, values):
    """Another array of that name."""
    del root["data"][name]
    if values is not None:
        with zarr.config.set({"array.write_empty_chunks": True}):
            root["data"].create_array(name, data=values)


def changed(name, change):
    def damage(root):
        values = root["data"][name][:]
        replaced(root, name, change(values))

    return damage


def set_value(name, index, value):
    def damage(root):
        root["data"][name][index] = value

    return damage


def other_ends(root):
    root["meta/episode_ends"][:] = [300, 300]


RIGHT = "right_tactile_{}_fingertip_6x4"
DAMAGES = [
    (other_ends, r"meta/episode_ends: \[300, 300\] found, rising numbers"),
    (changed("timestamps", lambda values: values[:-1]), r"timestamps: shape \(299,\) found, 300 frames expected"),
    (set_value("timestamps", 7, 0.0), "timestamps: frame 7 is not later than the frame before"),
    (set_value("sub_task_instruction", 9, " "), "sub_task_instruction: no text in frame 9"),
    (changed("camera_main_rgb", lambda values: None), "no RGB stream: one of camera_main_rgb, camera_ego_rgb"),
    (changed("camera_main_rgb", lambda values: values[..., 0]), r"camera_main_rgb: uint8 \(300, 24, 96\) found"),
    (changed(RIGHT.format("sensor"), lambda values: None), "right_tactile_sensor_fingertip_6x4: missing"),
    (changed(RIGHT.format("data"), lambda values: values[:, :, 0, 0]), r"data_fingertip_6x4: shape \(300, 2\) found, \(T, N, \*shape\)"),
    (changed(RIGHT.format("area"), lambda values: values[:, :1]), r"area_fingertip_6x4: shape \(300, 1\) found, \(300, 2\) expected"),
    (set_value(RIGHT.format("area"), (3, 1), 24), "area_fingertip_6x4: 24 found in frame 3, 0 to 23 expected"),
    (set_value(RIGHT.format("type"), 3, "force"), "type_fingertip_6x4: 'force' found, state, binary, image expected"),
    (changed(RIGHT.format("type"), lambda values: np.full(len(values), "image")), None),
    (changed("left_wrist_pose", lambda values: np.ones((300, 7))), r"left_wrist_pose: shape \(300, 7\) found, \(T, 6\) expected"),
    (changed("left_arm_joints", lambda values: np.ones((300, 8))), r"left_arm_joints: shape \(300, 8\) found, \(T, 1 to 7\) expected"),
    (changed("right_hand_joints_idx", lambda values: None), "right_hand_joints and right_hand_joints_idx: .* and none found"),
    (set_value("right_hand_joints_idx", (5, 0), 32), "right_hand_joints_idx: 32 found in frame 5, 0 to 31 expected"),
    (set_value("right_hand_joints", (5, 0), np.nan), "right_hand_joints: nan found in frame 5, a finite number expected"),
]


@pytest.mark.parametrize(("damage", "message"), DAMAGES)
def test_each_rule_can_be_broken(copied_grasp, damage, message):
    damage(zarr.open_group(copied_grasp, mode="r+"))
    broken = [fault for rule, faults in rules.check(rules.open_store(copied_grasp)) for fault in faults if not rule.is_note]
    if message is None:
        assert not broken
    else:
        assert len(broken) == 1
        assert re.search(message, broken[0]), broken


def test_images_and_states_are_rules_as_well(copied_grasp):
    root = zarr.open_group(copied_grasp, mode="r+")
    replaced(root, RIGHT.format("type"), np.full(300, "image"))
    replaced(root, RIGHT.format("data"), np.ones((300, 2, 4, 4, 4), np.float32))
    for name in ("left_wrist_pose", "left_arm_joints", "right_hand_joints", "right_hand_joints_idx"):
        replaced(root, name, None)
    broken = [fault for rule, faults in rules.check(rules.open_store(copied_grasp)) for fault in faults if not rule.is_note]
    assert broken[0].startswith("right_tactile_data_fingertip_6x4: shape (300, 2, 4, 4, 4) found")
    assert broken[1].startswith("no state: one of right_wrist_pose")


def test_released_sets_have_matrices_and_that_is_a_note(copied_grasp):
    replaced(zarr.open_group(copied_grasp, mode="r+"), RIGHT.format("type"), np.full(300, "matrix"))
    notes = [(faults, rule.is_note) for rule, faults in rules.check(rules.open_store(copied_grasp)) if faults]
    assert notes[0] == (["right_tactile_type_fingertip_6x4: 'matrix' found, state, binary, image expected"], True)
    assert all(is_note for _, is_note in notes)


def test_pictures_may_be_packed_by_a_codec_that_is_not_installed(grasped, copied_grasp):
    """Metadata as in released sets. The reader takes touch all the same."""
    file = copied_grasp / "data/camera_main_rgb/.zarray"
    file.write_text(json.dumps(json.loads(file.read_text()) | {"compressor": {"id": "imagecodecs_jpegxl"}}))
    store = rules.open_store(copied_grasp)
    assert not [faults for rule, faults in rules.check(store) if faults and not rule.is_note]
    np.testing.assert_array_equal(read_oxt(copied_grasp).column("a0_r1_c1"), taxelsim.Dataset(grasped)["data/left/tactile_image"][:, 1, 1])
    with pytest.raises(taxelsim.InputError, match="camera_main_rgb: packed by the codec imagecodecs_jpegxl, which is not installed"):
        store.arrays["camera_main_rgb"][0]


def test_a_lost_and_a_damaged_chunk_are_no_zeros(copied_grasp):
    chunk = copied_grasp / "data/right_tactile_data_fingertip_6x4/0.0.0.0"
    content = chunk.read_bytes()
    chunk.unlink()
    message = "right_tactile_data_fingertip_6x4: 1 of 1 chunks are missing, and Zarr reads them as 0"
    with pytest.raises(taxelsim.InputError, match=message):
        read_oxt(copied_grasp)
    root = zarr.open_group(copied_grasp, mode="r+")
    del root.attrs["taxelsim"]  # of another program: such a chunk may have been all zeros
    notes = [faults[0] for rule, faults in rules.check(rules.open_store(copied_grasp)) if faults and rule.is_note]
    assert any(note.startswith(message) for note in notes)
    chunk.write_bytes(content[:40])
    with pytest.raises(taxelsim.InputError, match="right_tactile_data_fingertip_6x4: frames 0 to 299: "):
        read_oxt(copied_grasp).column("a0_r1_c1")


def test_the_command_inspect(exported_grasp, copied_grasp, capfd):
    main = importlib.import_module("taxelsim.commands.inspect").main
    assert main([str(exported_grasp), "--format", "oxt", "--json"]) == 0
    assert json.loads(capfd.readouterr().out)["passed"] is True
    replaced(zarr.open_group(copied_grasp, mode="r+"), "camera_main_rgb", None)
    assert main([str(copied_grasp), "--format", "oxt"]) == 2
    shown = capfd.readouterr()
    assert "broken  at least one RGB stream, uint8 (T, H, W, 3)" in shown.out
    assert shown.err.startswith(f"taxelsim inspect: {copied_grasp}: no RGB stream")
    assert shown.err.count("\n") == 1


def test_the_command_export(grasped, tmp_path, capfd):
    main = importlib.import_module("taxelsim.commands.export").main
    words = [str(grasped), "--format", "oxt", "--episodes", "0..0", "-o", str(tmp_path / "out.zarr")]
    assert main([*words, "--place", ",".join(PLACE), "--joints", "right:jaw=28,left:bend", "--wrist", "below", "--camera", "arrays"]) == 0
    arrays = zarr.open_group(tmp_path / "out.zarr", mode="r")["data"]
    np.testing.assert_array_equal(arrays["right_wrist_pose"][:, :3], taxelsim.Dataset(grasped)["data/below/sensor_pose"][:150, :3])
    capfd.readouterr()  # the progress of a slow machine
    assert main(words) == 2
    assert capfd.readouterr().err.count("\n") == 1


def test_the_way_back_loses_nothing(folder, exported, tmp_path):
    """Export, import, compare: the images are those of the data set. The unit is that of the metadata."""
    recording = read_oxt(exported("oxt"))
    what = Measurement("images", SENSOR, TOUCH.format("data") + ".a0_r{row}_c{col}")
    write_measurement(recording, what, tmp_path / "back.yaml")
    shown = subprocess.run([PROGRAM, "compare", tmp_path / "back.yaml", folder, "--json"], capture_output=True, text=True)
    assert shown.returncode == 0, shown.stderr
    pairs = json.loads(shown.stdout)["pairs"]
    assert len(pairs) == NUM_EPISODES * NUM_FRAMES
    assert all(pair["M4_relative_l1"] in (0, None) and pair["M3_rms_difference"] in (0, None) for pair in pairs)
    data = taxelsim.Dataset(folder)
    np.testing.assert_array_equal(recording.column("timestamps"), data["data/time"][:])
    poses = np.stack([recording.column(f"right_wrist_pose.{name}") for name in ("x", "y", "z", "rx", "ry", "rz")], axis=1)
    np.testing.assert_allclose(layout.quaternion_poses(poses), data["data/sensor_pose"][:], atol=1e-14)


def test_an_episode_with_its_time(grasped, exported_grasp, tmp_path):
    sensor = taxelsim.SCENES / "sensors/fingertip_6x4.yaml"
    what = Measurement("images", sensor, "right_tactile_data_fingertip_6x4.a2_r{row}_c{col}", time="timestamps")
    table = write_measurement(read_oxt(exported_grasp, 1), what, tmp_path / "out.yaml")
    rows = np.loadtxt(table, delimiter=",", skiprows=1)
    data = taxelsim.Dataset(grasped).episode(1)
    np.testing.assert_allclose(rows[:, 0], data["data/time"], rtol=1e-9)
    np.testing.assert_array_equal(rows[:, 1:], data["data/below/tactile_image"].reshape(len(rows), -1))


def test_sets_that_are_none(exported_grasp, copied_grasp, tmp_path, exported):
    replaced(zarr.open_group(copied_grasp, mode="r+"), "camera_main_rgb", None)
    with pytest.raises(taxelsim.InputError, match=r"no RGB stream: .*; taxelsim inspect --format oxt lists all rules"):
        read_oxt(copied_grasp)
    with pytest.raises(taxelsim.InputError, match="Zarr version 3 is not allowed: version 2"):
        read_oxt(exported("zarr", zarr_format=3))
    with pytest.raises(taxelsim.InputError, match="no Open-X-Tactile set: a Zarr folder of version 2"):
        read_oxt(tmp_path)
    zarr.open_group(tmp_path / "bare", mode="w", zarr_format=2)
    with pytest.raises(taxelsim.InputError, match=r"^\S+/bare: no Open-X-Tactile set: data/ and meta/episode_ends expected$"):
        read_oxt(tmp_path / "bare")
    with pytest.raises(taxelsim.InputError, match="no frames of episode 2; it has 2 episodes"):
        read_oxt(exported_grasp, 2)
    root = zarr.open_group(exported_grasp, mode="r")
    assert root["data/right_tactile_data_fingertip_6x4"].attrs["unit"] == "counts"
    unnamed = shutil.copytree(exported_grasp, tmp_path / "unnamed")
    del zarr.open_group(unnamed, mode="r+")["data/right_tactile_data_fingertip_6x4"].attrs["unit"]
    what = Measurement("images", taxelsim.SCENES / "sensors/fingertip_6x4.yaml", "a0_r{row}_c{col}")
    with pytest.raises(taxelsim.InputError, match="the unit of a0_r0_c0 is not stated: --unit counts"):
        write_measurement(read_oxt(unnamed), what, tmp_path / "out.yaml")
    assert not (tmp_path / "out.csv").exists()
