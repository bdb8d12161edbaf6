"""Columns of a recording against those of its data set."""

import numpy as np
import pytest

import taxelsim
from taxelsim.pictures import TACTILE_IMAGE, TAXEL_COUNTS, colours_of, range_of

from .conftest import write_viewed_scene

FLOAT32 = np.finfo(np.float32).eps  # components of positions, quaternions and vectors are float32


@pytest.fixture(scope="module")
def data(viewed):
    return taxelsim.Dataset(viewed)


@pytest.fixture(scope="module")
def brightest(data):
    """N, force of the brightest colour."""
    readout = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").readout
    return taxelsim.nominal_force(readout, range_of(data, TACTILE_IMAGE))


def test_records_what_the_data_set_has(recorded, viewed, data):
    found = recorded(viewed, [2, 1])
    for number in (1, 2):
        episode, root = data.episode(number), f"episode_{number}"
        sensor = f"{root}/world/sensor"
        np.testing.assert_array_equal(found[root + "/tactile_image", "frame"], np.arange(13))
        times = found[root + "/tactile_image", "time"].astype("timedelta64[ns]").astype(np.int64)
        np.testing.assert_allclose(times * 1e-9, episode["data/time"], atol=1e-9)
        for entity, poses in ((sensor, episode["data/sensor_pose"]), (f"{sensor}/object", episode["data/pose"])):
            np.testing.assert_allclose(found[entity, "Transform3D:translation"][:, 0], poses[:, :3], atol=FLOAT32)
            np.testing.assert_allclose(found[entity, "Transform3D:quaternion"][:, 0], poses[:, [4, 5, 6, 3]], atol=FLOAT32)
        images = found[f"{root}/tactile_image", "DepthImage:buffer"].astype(np.uint8).reshape(13, -1).view(np.uint16)
        np.testing.assert_array_equal(images.reshape(13, 6, 14), episode["data/tactile_image"])
        for name in ("total_force", "center_of_pressure", "eigenvalues"):
            values = episode[f"data/{name}"].reshape(13, -1)
            np.testing.assert_array_equal(found[f"{root}/features/{name}", "Scalars:scalars"], values)
            true = episode[f"data/ground_truth/{name}"].reshape(13, -1)
            np.testing.assert_array_equal(found[f"{root}/ground_truth/{name}", "Scalars:scalars"], true)
        np.testing.assert_array_equal(found[f"{root}/actions/action", "Scalars:scalars"], episode["data/action"])
        assert found[f"{root}/actions/action", "SeriesLines:names"].tolist() == [
            f"action {v}" for v in ("v_x", "v_y", "v_z", "w_x", "w_y", "w_z")
        ]
    assert not any(entity.startswith(("episode_0", "episode_3")) for entity in found.entities)
    assert [len(found.reader.recordings()), len(found.reader.blueprints())] == [1, 1]


def test_taxels_have_the_colours_of_their_forces(recorded, viewed, data, brightest):
    found = recorded(viewed, [0, 3])
    forces = {number: data.episode(number)["data/ground_truth/tactile_normal_force"].reshape(13, 84) for number in (0, 3)}
    for number, force in forces.items():
        entity = f"episode_{number}/world/sensor/taxels"
        colours = found[entity, "Mesh3D:vertex_colors"].astype(np.uint32).reshape(13, 84, 4)
        expected = (
            colours_of(force.astype(np.float64) / brightest).astype(np.uint32) @ np.array([1 << 24, 1 << 16, 1 << 8], np.uint32) + 255
        )
        np.testing.assert_array_equal(colours, np.repeat(expected[..., None], 4, -1))
        corners = found[entity, "Mesh3D:vertex_positions"].reshape(84, 4, 3)
        positions = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").taxel_positions
        np.testing.assert_allclose(corners.mean(1), positions, atol=FLOAT32)
    assert len(np.unique(colours)) > 10


def test_shear_arrows_are_the_recorded_forces(recorded, viewed, data, brightest):
    found = recorded(viewed, 1)
    shear = data.episode(1)["data/ground_truth/tactile_shear_force"].reshape(13, 84, 2)
    assert shear.any()
    vectors = found["episode_1/world/sensor/shear", "Arrows3D:vectors"]
    pitch, longest = 0.0034, 2.0  # m, pitches
    np.testing.assert_allclose(vectors[..., :2], shear * longest * pitch / brightest, atol=FLOAT32 * longest * pitch)
    np.testing.assert_array_equal(vectors[..., 2], 0)


def test_errors_are_measured_minus_true(recorded, viewed, data):
    found, episode = recorded(viewed, 1), data.episode(1)
    force = episode["data/total_force"].astype(float) - episode["data/ground_truth/total_force"]
    np.testing.assert_array_equal(found["episode_1/errors/total_force", "Scalars:scalars"][:, 0], force)
    assert np.abs(force).max() > 0
    exact = episode["data/edge_angle"].astype(float) - episode["data/ground_truth/exact_edge_angle"]
    error = found["episode_1/errors/exact_edge_angle", "Scalars:scalars"][:, 0]
    np.testing.assert_allclose(np.sin(error - exact), 0, atol=1e-12)
    assert np.abs(error).max() <= np.pi / 2


def test_object_is_the_cylinder_of_the_scene(recorded, viewed):
    vertices = recorded(viewed, 0)["episode_0/world/sensor/object", "Mesh3D:vertex_positions"]
    assert np.hypot(*vertices[:, :2].T).max() == pytest.approx(0.004, abs=1e-9)
    assert np.abs(vertices[:, 2]).max() == pytest.approx(0.05, abs=1e-9)


def test_a_scene_is_simulated_as_its_data_set(recorded, viewed_scene, tmp_path, device):
    taxelsim.generate(viewed_scene, tmp_path / "data", episodes=[3], device=device)
    simulated, read = recorded(viewed_scene, [3], device=device), recorded(tmp_path / "data", [3])
    assert simulated.columns.keys() == read.columns.keys()
    for key in read.columns:
        np.testing.assert_array_equal(simulated[key], read[key])


def test_first_episodes_are_the_default(recorded, viewed):
    numbers = {entity.partition("/")[0] for entity in recorded(viewed).entities if entity.startswith("episode_")}
    assert numbers == {"episode_0", "episode_1", "episode_2"}


def test_several_sensors_have_entities_of_their_own(recorded, tmp_path, device):
    mounts = "{pan_tilt: {sensors: [{link: tilt}, {link: tilt, mount: {position_mm: [0, 60, 30]}}]}}"
    scene = write_viewed_scene(tmp_path, robot=mounts, episodes=1)
    found = recorded(scene, device=device)
    first, second = (found[f"episode_0/world/sensor_{k}", "Transform3D:translation"][:, 0] for k in (0, 1))
    assert np.linalg.norm(first - second, axis=1).min() > 0.02
    images = [found[f"episode_0/tactile_image_{k}", "DepthImage:buffer"] for k in (0, 1)]
    assert all(image.shape == (13, 1, 6 * 14 * 2) and image.any() for image in images)
    assert (images[0] != images[1]).any()
    assert {"episode_0/sensor_0/features/total_force", "episode_0/sensor_1/features/total_force"} <= found.entities
    assert "episode_0/world/sensor_1/object" not in found.entities


def test_without_forces_the_counts_give_the_colours(recorded, tmp_path, device):
    scene = write_viewed_scene(tmp_path, record="tactile_image, poses", friction=False, episodes=1)
    scene.write_text(scene.read_text().replace("noise: [0, 20]", "noise: 0"))
    taxelsim.generate(scene, tmp_path / "data", device=device)
    found = recorded(tmp_path / "data")
    counts = taxelsim.Dataset(tmp_path / "data").episode(0)["data/tactile_image"].reshape(13, 84)
    colours = found["episode_0/world/sensor/taxels", "Mesh3D:vertex_colors"].reshape(13, 84, 4)[..., 0]
    order = np.argsort(counts, axis=None)
    assert colours.ravel()[order[-1]] == 0xFDE725FF  # the brightest colour
    assert len(np.unique(colours[counts == 0])) <= 1
    assert "episode_0/world/sensor/shear" not in found.entities


def test_counts_of_three_axis_taxels_are_images_and_arrows(recorded, tmp_path, device):
    scene = write_viewed_scene(tmp_path, record="tactile_image, taxel_counts, poses", friction=False, episodes=1)
    shipped = str((taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").resolve())
    scene.write_text(scene.read_text().replace(shipped, str((taxelsim.SCENES / "sensors/uskin_like_4x4.yaml").resolve())))
    taxelsim.generate(scene, tmp_path / "data", device=device)
    found = recorded(tmp_path / "data")
    dataset = taxelsim.Dataset(tmp_path / "data")
    counts, largest = dataset.episode(0)[TAXEL_COUNTS], range_of(dataset, TAXEL_COUNTS)
    assert counts.shape == (13, 4, 4, 3)
    for axis, name in enumerate(("x", "y", "normal")):
        images = found[f"episode_0/taxel_counts/{name}", "DepthImage:buffer"].astype(np.uint8).reshape(13, -1).view(np.int32)
        np.testing.assert_array_equal(images.reshape(13, 4, 4), counts[..., axis])
        low, high = found[f"episode_0/taxel_counts/{name}", "DepthImage:depth_range"].ravel()
        assert (low, high) == (0 if name == "normal" else -largest, largest)
    arrows = found["episode_0/world/sensor/shear_counts", "Arrows3D:vectors"].reshape(13, 4, 4, 3)
    np.testing.assert_allclose(arrows[..., :2], counts[..., :2] * (2 * 4.7e-3 / largest), atol=4 * FLOAT32)
    assert not arrows[..., 2].any()
    assert not any("taxel_counts" in entity for entity in found.entities if "features" in entity)
