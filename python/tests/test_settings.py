"""Sensors, objects and options: made from keywords, immutable, compared by value, pickled."""

import copy
import pickle

import numpy as np
import pytest

import taxelsim

SETTINGS = [
    taxelsim.Pose(position=(1, 2, 3)),
    taxelsim.Cylinder(radius=0.008, length=0.04),
    taxelsim.Box(size=(0.1, 0.2, 0.3)),
    taxelsim.HalfSpace(),
    taxelsim.Object(taxelsim.Sphere(radius=0.01), name="ball"),
    taxelsim.Mesh(np.eye(3), [[0, 1, 2]]),
    taxelsim.Skin(thickness=0.002, law=taxelsim.ElasticLayer(elastic_modulus=1e6, base=taxelsim.ElasticLayer.Base.HALF_SPACE)),
    taxelsim.gaussian_psf(0.7, 3, taxelsim.Psf.Normalization.NONE),
    taxelsim.Readout(creep=[taxelsim.CreepTerm(fraction=0.1, time=2)], curve=[1, 2]),
    taxelsim.OutputOptions(contact_features=True),
    taxelsim.SimulatorOptions(num_instances=7, seed=2**63),
    taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_elastic_layer.yaml"),
]


@pytest.mark.parametrize("settings", SETTINGS, ids=lambda s: type(s).__name__)
def test_settings_pickle_and_compare_by_value(settings):
    loaded = pickle.loads(pickle.dumps(settings))
    assert type(loaded) is type(settings)
    assert loaded == settings
    assert copy.deepcopy(settings) == settings
    assert settings != 3


def test_replace_changes_one_field_of_a_copy():
    skin = taxelsim.Skin(thickness=0.002)
    thicker = skin.replace(thickness=0.003)
    assert (skin.thickness, thicker.thickness) == (0.002, 0.003)
    assert skin != thicker
    with pytest.raises(AttributeError):
        skin.thickness = 0.004
    with pytest.raises(TypeError):
        skin.replace(thicknes=0.004)


def test_settings_print_as_the_call_that_makes_them():
    assert repr(taxelsim.Cylinder(radius=0.008, length=0.04)) == "Cylinder(radius=0.008, length=0.04)"
    assert repr(taxelsim.Object(taxelsim.Sphere(radius=1.0))) == "Object(shape=Sphere(radius=1.0), name='sphere')"


def test_the_same_sensor_comes_from_keywords_and_from_a_file(tmp_path):
    sensor = taxelsim.Sensor(
        name="pad",
        patches=[taxelsim.GridPatch(name="pad", num_rows=4, num_cols=5, pitch=(0.002, 0.003))],
        depth_sampling=taxelsim.DepthSampling.AREA,
        skin=taxelsim.Skin(thickness=0.002, law=taxelsim.Winkler(normal_contact_stiffness=1e8)),
        psf=taxelsim.gaussian_psf(0.5, 3),
        readout=taxelsim.Readout(noise=1.5),
    )
    file = tmp_path / "pad.yaml"
    file.write_text(taxelsim.sensor_text(sensor, {"": "a test"}))
    assert taxelsim.load_sensor(file) == sensor
    assert sensor.num_taxels == 20
    assert sensor.taxel_positions.shape == (20, 3)
    assert sensor.taxel_positions[0] == pytest.approx([-0.003, -0.006, 0])
    assert (sensor.taxel_normals == [0, 0, 1]).all()


def test_wrong_sensors_name_their_field(device):
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    with pytest.raises(taxelsim.InputError, match=r"readout\.noise"):
        taxelsim.check_sensor(sensor.replace(readout=sensor.readout.replace(noise=-1)))
    with pytest.raises(taxelsim.InputError, match=r"skin\.thickness"):
        taxelsim.Model(device, sensor.replace(skin=sensor.skin.replace(thickness=0)))
    with pytest.raises(taxelsim.InputError, match="radius"):
        taxelsim.Model(device, sensor, [taxelsim.Sphere(radius=-1)])
    with pytest.raises(TypeError):
        taxelsim.Sphere(radius="large")


def test_meshes_come_from_arrays_and_files(tmp_path):
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) * 0.01
    triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    mesh = taxelsim.Mesh(vertices, triangles)
    assert mesh.vertices.dtype == np.float32
    assert mesh.vertices == pytest.approx(vertices)
    assert not mesh.vertices.flags.writeable
    assert mesh.triangles.tolist() == triangles
    low, high = taxelsim.bounds_of(mesh)
    assert (low, high) == (pytest.approx([0, 0, 0]), pytest.approx([0.01, 0.01, 0.01]))
    lines = [f"v {1000 * x} {1000 * y} {1000 * z}" for x, y, z in vertices] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in triangles]
    file = tmp_path / "tetrahedron_mm.obj"
    file.write_text("\n".join(lines) + "\n")
    loaded = taxelsim.load_mesh(file, scale=0.001)
    assert len(loaded.triangles) == 4
    assert taxelsim.bounds_of(loaded)[1] == pytest.approx([0.01, 0.01, 0.01])
    assert taxelsim.lowest_point(taxelsim.Sphere(radius=0.5), (1, 0, 0, 0)) == pytest.approx([0, 0, -0.5])


@pytest.mark.parametrize(
    ("vertices", "triangles", "message"),
    [
        (np.eye(3).T[:2].T, [[0, 1, 2]], r"vertices: shape \(3, 2\) is not allowed: \(V, 3\)"),
        (np.eye(3), [[0, 1, 3]], "index|3"),
        (np.eye(3), [[0, 1, -1]], "triangles: -1 of index .* is not allowed"),
        (np.eye(3), [[0.0, 1, 2]], "triangles: dtype float64 is not allowed: integers"),
        (np.eye(3) * np.nan, [[0, 1, 2]], r"vertices: nan of index \(0, 0\) is not finite"),
        (np.eye(3), np.empty((0, 3), int), "no triangle|triangle"),
        (np.zeros((3, 4)), [[0, 1, 2]], r"vertices: shape \(3, 4\) is not allowed"),
    ],
)
def test_wrong_meshes_are_refused(vertices, triangles, message):
    with pytest.raises(taxelsim.InputError, match=message):
        taxelsim.Mesh(vertices, triangles)


def test_poses_compose():
    pose = taxelsim.Pose(position=(1, 0, 0), rotation=taxelsim.axis_angle((0, 0, 1), np.pi / 2))
    assert (pose * pose.inverse()).position == pytest.approx([0, 0, 0])
    assert pose.transform((1, 0, 0)) == pytest.approx([1, 1, 0])


def test_missing_files_are_input_errors():
    with pytest.raises(taxelsim.InputError, match=r"nowhere\.yaml") as error:
        taxelsim.load_sensor("nowhere.yaml")
    assert error.value.instance is None
    assert isinstance(error.value, ValueError)
    assert isinstance(error.value, taxelsim.Error)
    with pytest.raises(taxelsim.InputError):
        taxelsim.parse_object("sfere:1")
    assert taxelsim.parse_object("sphere:0.5").shape == taxelsim.Sphere(radius=0.5)


def test_unknown_devices_are_device_errors():
    with pytest.raises(taxelsim.DeviceError, match="no such device"):
        taxelsim.Device.open("no such device")
    infos = taxelsim.list_devices()
    assert [info.index for info in infos] == list(range(len(infos)))
    assert taxelsim.Device.open("0").info == infos[0]


def test_scenes_pickle_with_their_overrides():
    scene = taxelsim.load_scene(taxelsim.SCENES / "edge_servo.yaml", num_episodes=3, seed=5)
    loaded = pickle.loads(pickle.dumps(scene))
    assert (loaded.num_episodes, loaded.seed, loaded.resolved) == (3, 5, scene.resolved)
    assert scene.kind == taxelsim.Scene.Kind.SERVO
    assert len(scene.controllers) >= 1
    assert scene.sensor.num_taxels == 84
