"""Arguments."""

import inspect
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

import taxelsim
import taxelsim.envs
import taxelsim.mujoco
from taxelsim.envs import TactileVectorEnv
from taxelsim.policies import OnnxPolicy
from taxelsim.vectorized import VectorEnvArguments

from ..envs.conftest import write_scene
from ..mujoco import models
from .tools import ROOT, write_cube

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
