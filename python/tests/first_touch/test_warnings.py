"""Warnings and questions."""

import logging
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import taxelsim
import taxelsim.envs
import taxelsim.mujoco
from taxelsim.program import PROGRAM

from .tools import press, servo, write_cube

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


def test_an_open_mesh_under_area_sampling_says_so_once(warnings, device):
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614.yaml")
    opened = taxelsim.Object(taxelsim.Mesh([[0, 0, 0], [0.01, 0, 0], [0, 0.01, 0]], [[0, 1, 2]]), name="leaf")
    for _ in range(2):
        taxelsim.Model(device, sensor, [opened, taxelsim.Sphere(radius=0.01)])
    line = "object leaf is a mesh that is not closed: depth_sampling: area takes its depth in the middle of each cell, as point does"
    assert warnings() == [line]
    taxelsim.Model(device, sensor.replace(depth_sampling="point"), [taxelsim.Object(opened.shape, name="other leaf")])
    assert not any("not closed" in each for each in warnings())


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
